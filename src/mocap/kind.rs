//! What kind of clip a file is: its extension says, its first bytes confirm.

use super::MocapError;

/// A kind of clip file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Biovision hierarchy.
    Bvh,
    /// Autodesk's, binary or text.
    Fbx,
    /// .gltf or .glb.
    Gltf,
    /// A VRM character with clips.
    Vrm,
    /// A VRM animation.
    Vrma,
}

/// Bytes that are looked at.
const LOOKED_AT: usize = 4096;

/// The kind of a file of that name and content.
pub fn of(name: &str, bytes: &[u8]) -> Result<Kind, MocapError> {
    let wrong = |what: &str, remedy: &str| {
        Err(MocapError::WrongKind { file: name.into(), what: what.into(), remedy: remedy.into() })
    };
    let base = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let extension = base.rsplit_once('.').map_or(String::new(), |(_, tail)| tail.to_ascii_lowercase());
    let by_name = match extension.as_str() {
        "bvh" => Some(Kind::Bvh),
        "fbx" => Some(Kind::Fbx),
        "glb" | "gltf" => Some(Kind::Gltf),
        "vrm" => Some(Kind::Vrm),
        "vrma" => Some(Kind::Vrma),
        _ => None,
    };
    if bytes.is_empty() {
        return wrong("is empty", "give a .bvh, .fbx, .glb, .gltf, .vrm or .vrma file");
    }
    let content = content(bytes);
    let gltf = |kind: &Kind| matches!(kind, Kind::Gltf | Kind::Vrm | Kind::Vrma);
    match (by_name, content) {
        (Some(named), Content::Clip(found)) if named == found || (gltf(&named) && gltf(&found)) => Ok(named),
        (Some(_), Content::Clip(found)) => {
            let (what, extension) = match found {
                Kind::Bvh => ("is a BVH motion by its content, not what its name says", ".bvh"),
                Kind::Fbx => ("is an FBX file by its content, not what its name says", ".fbx"),
                _ => ("is a glTF file by its content, not what its name says", ".glb or .gltf"),
            };
            wrong(what, &format!("let its name end in {extension}"))
        }
        (None, Content::Clip(found)) => Ok(found),
        (_, Content::Html) => wrong("is a web page, not a clip", "download the file itself (the raw file)"),
        (_, Content::Pointer) => wrong("is a Git LFS pointer, not the clip", "fetch it with `git lfs pull`"),
        (_, Content::Utf16) => wrong("is UTF-16 text", "save it as UTF-8 or plain ASCII"),
        // What is broken from its first byte on is told by its parser, with the place.
        (Some(named), Content::Unknown) => Ok(named),
        (None, Content::Unknown) => {
            wrong("is no clip that can be read", "give a .bvh, .fbx, .glb, .gltf, .vrm or .vrma file")
        }
    }
}

enum Content {
    Clip(Kind),
    Html,
    Pointer,
    Utf16,
    Unknown,
}

fn content(bytes: &[u8]) -> Content {
    let head = &bytes[..bytes.len().min(LOOKED_AT)];
    if head.starts_with(&[0xFF, 0xFE]) || head.starts_with(&[0xFE, 0xFF]) {
        return Content::Utf16;
    }
    if head.starts_with(b"glTF") {
        return Content::Clip(Kind::Gltf);
    }
    let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
    let starts = |what: &[u8]| text.len() >= what.len() && text[..what.len()].eq_ignore_ascii_case(what);
    let holds = |what: &[u8]| text.windows(what.len()).any(|part| part == what);
    if starts(b"Kaydara FBX") || starts(b"; FBX") || holds(b"FBXHeaderExtension") {
        Content::Clip(Kind::Fbx)
    } else if starts(b"HIERARCHY") {
        Content::Clip(Kind::Bvh)
    } else if starts(b"{") {
        Content::Clip(Kind::Gltf)
    } else if starts(b"<!doctype") || starts(b"<html") || starts(b"<?xml") {
        Content::Html
    } else if starts(b"version https://git-lfs") {
        Content::Pointer
    } else {
        Content::Unknown
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_content_is_asked_whether_the_name_is_true() {
        assert_eq!(of("a/Walk.BVH", b"\xef\xbb\xbf\r\nHierarchy\n").expect("a BVH"), Kind::Bvh);
        assert_eq!(of("walk.vrma", b"glTF\x02").expect("a glTF"), Kind::Vrma);
        assert_eq!(of("walk", b"; FBX 7.4.0 project file").expect("an FBX"), Kind::Fbx);
        let told = |name: &str, bytes: &[u8]| of(name, bytes).expect_err(name).to_string();
        assert!(told("w.bvh", b"<!DOCTYPE html><html>").contains("web page"));
        assert!(told("w.bvh", b"Kaydara FBX Binary  ").contains("let its name end in .fbx"));
        assert!(told("w.fbx", b"HIERARCHY\nROOT").contains(".bvh"));
        assert!(told("w.fbx", b"version https://git-lfs.github.com/spec/v1").contains("git lfs pull"));
        assert!(told("w.c3d", b"\x02\x50").contains("no clip"));
        assert!(told("w.glb", b"").contains("is empty"));
    }
}
