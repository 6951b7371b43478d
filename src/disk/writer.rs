//! Puts finished bytes on the disk: whole or not at all, several files together, never over an input.
//!
//! Each file is written beside its place, synced, then renamed. If one of several cannot be put in its place, those
//! before it are taken back. Folders that lack are made. A device, a folder or a write-protected file is never replaced.

use super::Failure;
use super::staged;
use std::fs;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// How the names of files begin and end that are not in their place yet.
pub const STAGED: (&str, &str) = (".surefoot-", ".tmp");

/// A file to write.
#[derive(Clone, Debug)]
pub struct Output {
    /// Where.
    pub path: PathBuf,
    /// What.
    pub bytes: Vec<u8>,
}

/// Refuses outputs that are inputs, each other, or no plain files. Cheap: called before the work as well as before writing.
pub fn check(outputs: &[&Path], inputs: &[PathBuf]) -> Result<(), Failure> {
    for (index, output) in outputs.iter().enumerate() {
        if output.file_name().is_none() {
            return Err(Failure::bad_input(format!("{}: not the name of a file", output.display())));
        }
        if let Some(input) = inputs.iter().find(|input| same_file(input, output)) {
            return Err(Failure::bad_input(format!(
                "{}: this is the input {}, which is never overwritten\n  help: give -o another name",
                output.display(),
                input.display()
            )));
        }
        if outputs[..index].iter().any(|other| other == output || same_file(other, output)) {
            return Err(Failure::bad_input(format!("{}: two results cannot share one file", output.display())));
        }
        match fs::metadata(output) {
            Ok(there) if there.is_dir() => {
                return Err(Failure::bad_input(format!(
                    "{}: this is a folder\n  help: name a file in it",
                    output.display()
                )));
            }
            Ok(there) if !there.is_file() => {
                return Err(Failure::bad_input(format!("{}: not a plain file", output.display())));
            }
            Ok(there) if there.permissions().readonly() => {
                return Err(Failure::bad_input(format!(
                    "{}: the file is write-protected\n  help: give -o another name, or lift the protection",
                    output.display()
                )));
            }
            Ok(_) | Err(_) => {}
        }
    }
    Ok(())
}

/// Writes them all, or none.
pub fn write(outputs: &[Output], inputs: &[PathBuf]) -> Result<(), Failure> {
    check(&outputs.iter().map(|output| output.path.as_path()).collect::<Vec<_>>(), inputs)?;
    let mut staged = Vec::with_capacity(outputs.len());
    for output in outputs {
        staged.push((stage(output).map_err(|error| cannot_write(&output.path, &error))?, target(&output.path)));
    }
    // An interrupt waits from here to the end.
    let mut listed = staged::staged();
    listed.retain(|path| staged.iter().all(|(file, _)| file.path() != path));
    place(staged)
}

/// Renames finished files to their places; if one cannot be, those before it are taken back.
fn place(staged: Vec<(NamedTempFile, PathBuf)>) -> Result<(), Failure> {
    let mut placed: Vec<Placed> = Vec::with_capacity(staged.len());
    for (file, target) in staged {
        let earlier = keep(&target);
        if let Err(error) = file.persist(&target) {
            let failure = cannot_write(&target, &error.error);
            for done in placed.into_iter().rev() {
                done.take_back();
            }
            return Err(failure);
        }
        placed.push(Placed { path: target, earlier });
    }
    Ok(())
}

/// A file in its place, and what stood there before.
struct Placed {
    path: PathBuf,
    earlier: Option<tempfile::TempPath>,
}

impl Placed {
    /// As it was before; where that fails too, nothing better can be done.
    fn take_back(self) {
        match self.earlier {
            Some(earlier) => drop(earlier.persist(&self.path)),
            None => drop(fs::remove_file(&self.path)),
        }
    }
}

/// Where a path leads: a link is written through, not replaced.
fn target(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf())
}

fn folder(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The bytes in a file beside their place.
fn stage(output: &Output) -> std::io::Result<NamedTempFile> {
    let target = target(&output.path);
    let folder = folder(&target);
    fs::create_dir_all(folder)?;
    let mut file = {
        let mut listed = staged::staged();
        let file = beside(folder)?;
        listed.push(file.path().to_path_buf());
        file
    };
    file.write_all(&output.bytes)?;
    file.as_file().sync_all()?;
    Ok(file)
}

fn beside(folder: &Path) -> std::io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(STAGED.0).suffix(STAGED.1);
    #[cfg(unix)]
    {
        // What any new file gets; the umask takes its part.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

/// A copy of what stands at that place; `None` where nothing does, or no copy could be made.
fn keep(path: &Path) -> Option<tempfile::TempPath> {
    if !path.exists() {
        return None;
    }
    let copy = beside(folder(path)).ok()?.into_temp_path();
    fs::copy(path, &copy).ok()?;
    Some(copy)
}

/// Whether two paths lead to one file, be it by links. Hard links are known on Unix only. Elsewhere a result replaces such a link, and the
/// input that shares its bytes stays as it was: files are renamed into their places, never written through.
fn same_file(a: &Path, b: &Path) -> bool {
    let (Ok(canonical_a), Ok(canonical_b)) = (fs::canonicalize(a), fs::canonicalize(b)) else { return false };
    if canonical_a == canonical_b {
        return true;
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        if let (Ok(a), Ok(b)) = (fs::metadata(a), fs::metadata(b)) {
            return (a.dev(), a.ino()) == (b.dev(), b.ino());
        }
    }
    false
}

fn cannot_write(path: &Path, error: &std::io::Error) -> Failure {
    let remedy = match error.kind() {
        // Windows does not replace a file that another program holds open.
        ErrorKind::PermissionDenied if cfg!(windows) => {
            "close the file where it is open, or write to a folder that is yours"
        }
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => "write to a folder that is yours",
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "make room, or write to another disk",
        ErrorKind::NotADirectory | ErrorKind::AlreadyExists => "a part of the path is a file: give another folder",
        ErrorKind::InvalidFilename => "give a shorter or simpler name",
        _ => "nothing was written; try another folder",
    };
    Failure::failed(format!("{}: cannot be written: {error}\n  help: {remedy}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn output(path: PathBuf, bytes: &[u8]) -> Output {
        Output { path, bytes: bytes.to_vec() }
    }

    fn listing(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("the test's own folder");
        let mut names: Vec<String> =
            entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    #[test]
    fn writes_whole_files_and_makes_their_folder() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("a/b/out.glb");
        write(&[output(path.clone(), b"one")], &[]).expect("written");
        write(&[output(path.clone(), b"two")], &[]).expect("written over its own earlier result");
        assert_eq!(fs::read(&path).expect("there"), b"two");
        assert_eq!(listing(path.parent().expect("a folder")), ["out.glb"]);
    }

    #[test]
    fn an_input_is_refused_by_any_of_its_names() {
        let folder = tempfile::tempdir().expect("a folder");
        let input = folder.path().join("hero.glb");
        fs::write(&input, b"hero").expect("written");
        let mut names = vec![input.clone(), folder.path().join("./hero.glb")];
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(&input, folder.path().join("soft.glb")).expect("a link");
            names.push(folder.path().join("soft.glb"));
            fs::hard_link(&input, folder.path().join("hard.glb")).expect("a link");
            names.push(folder.path().join("hard.glb"));
        }
        for name in names {
            let failure = write(&[output(name.clone(), b"x")], std::slice::from_ref(&input)).expect_err("an input");
            assert!(failure.message.contains("never overwritten"), "{name:?}: {}", failure.message);
        }
        assert_eq!(fs::read(&input).expect("there"), b"hero");
    }

    #[test]
    fn two_files_come_together_or_not_at_all() {
        let folder = tempfile::tempdir().expect("a folder");
        let (good, bad) = (folder.path().join("out.glb"), folder.path().join("file/out.json"));
        fs::write(&good, b"old").expect("written");
        fs::write(folder.path().join("file"), b"in the way").expect("written");
        write(&[output(good.clone(), b"new"), output(bad, b"new")], &[]).expect_err("the second cannot be written");
        assert_eq!(fs::read(&good).expect("there"), b"old");
        assert_eq!(listing(folder.path()), ["file", "out.glb"]);
    }

    #[test]
    fn what_stood_there_is_put_back() {
        let folder = tempfile::tempdir().expect("a folder");
        let (old, fresh) = (folder.path().join("old"), folder.path().join("fresh"));
        fs::write(&old, b"before").expect("written");
        for path in [&old, &fresh] {
            let earlier = keep(path);
            fs::write(path, b"after").expect("written");
            Placed { path: path.clone(), earlier }.take_back();
        }
        assert_eq!(fs::read(&old).expect("there"), b"before");
        assert_eq!(listing(folder.path()), ["old"]);
    }

    #[test]
    fn folders_devices_and_protected_files_are_not_replaced() {
        let folder = tempfile::tempdir().expect("a folder");
        let locked = folder.path().join("locked.glb");
        fs::write(&locked, b"x").expect("written");
        let mut permissions = fs::metadata(&locked).expect("there").permissions();
        permissions.set_readonly(true);
        fs::set_permissions(&locked, permissions).expect("set");
        let mut paths = vec![folder.path().to_path_buf(), locked];
        if cfg!(unix) {
            paths.push(PathBuf::from("/dev/null"));
        }
        for path in paths {
            assert!(write(&[output(path.clone(), b"x")], &[]).is_err(), "{path:?}");
        }
    }

    #[test]
    fn two_results_cannot_share_a_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("out");
        write(&[output(path.clone(), b"a"), output(path.clone(), b"b")], &[]).expect_err("the same path twice");
        assert!(!path.exists());
    }
}
