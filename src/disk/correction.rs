//! A clip file that is corrected: opened with its bytes, each clip corrected, and the bytes of the corrected file.
//!
//! BVH stays BVH, glTF, VRM and VRMA keep their document, FBX becomes a GLB. What was written can be read back and compared with what
//! was meant.

use super::{Failure, resolve};
use crate::correct::{CorrectOptions, Corrected, correct, locals, told};
use crate::export::{Amended, amend};
use crate::mocap::{self, ClipFile, Kind, Options, Reading, bvh, bvh_write};
use crate::rig::Document;
use serde_json::Value;
use std::path::Path;

/// A clip file, opened to be corrected.
pub struct Opened {
    file: ClipFile,
    /// Of the file on the disk.
    kind: Kind,
    /// What the file will be written from.
    source: Vec<u8>,
    options: Options,
}

/// A clip that was corrected.
pub struct Clip {
    /// Which of the file's.
    pub index: usize,
    /// As it was.
    pub reading: Reading,
    /// As it is.
    pub corrected: Corrected,
    amended: Amended,
}

impl Clip {
    /// New local transforms of the file's nodes, file units.
    pub fn edits(&self) -> &locals::Edits {
        &self.amended.edits
    }
}

impl Opened {
    /// Opens a clip file. An FBX is judged as what will be written.
    pub fn open(path: &Path, options: &Options) -> Result<Opened, Failure> {
        resolve::plain_file(path, "a clip is a .bvh, .fbx, .glb, .gltf, .vrm or .vrma file")?;
        let bad = |error: mocap::MocapError| Failure::bad_input(error.to_string());
        let file = mocap::load(path).map_err(bad)?;
        let kind = file.kind;
        match file.fbx_to_glb(options) {
            Some(made) => {
                let source = made.map_err(bad)?;
                let name = path.with_extension("glb").display().to_string();
                let alone = |_: &str| Err(std::io::Error::from(std::io::ErrorKind::NotFound));
                let file = mocap::read(&name, &source, &alone, None).map_err(bad)?;
                // What FBX was turned into is in metres and Y up.
                Ok(Opened { file, kind, source, options: Options { fps: options.fps, ..Options::default() } })
            }
            None => {
                let source = std::fs::read(path)
                    .map_err(|error| Failure::bad_input(format!("{}: cannot be read: {error}", path.display())))?;
                Ok(Opened { file, kind, source, options: options.clone() })
            }
        }
    }

    /// Names of its clips.
    pub fn clips(&self) -> &[String] {
        &self.file.clips
    }

    /// The clip of that name.
    pub fn find(&self, name: &str) -> Result<usize, Failure> {
        self.file.find(name).map_err(|error| Failure::bad_input(error.to_string()))
    }

    /// Corrects one of its clips. The error is the clip's own where the file has others.
    pub fn correct(&self, index: usize, settings: &CorrectOptions) -> Result<Clip, Failure> {
        let reading = self.reading(index)?;
        self.correct_reading(index, reading, settings)
    }

    /// A clip of it, as it is.
    pub fn reading(&self, index: usize) -> Result<Reading, Failure> {
        self.file.reading(index, &self.options).map_err(|error| Failure::bad_input(error.to_string()))
    }

    /// The same of a clip that was read already.
    pub fn correct_reading(&self, index: usize, reading: Reading, settings: &CorrectOptions) -> Result<Clip, Failure> {
        let Some(source) = locals::Source::of(&self.file, index, &reading) else {
            return Err(Failure::failed(format!("{}: its tracks cannot be read again", self.file.file)));
        };
        let corrected = correct(&reading.capture, settings);
        let edits = locals::edits(&reading, &source, &corrected);
        let (start, fps, speed) = (reading.start, reading.capture.fps, corrected.speed);
        let amended = Amended { animation: index, start, fps, edits, speed, extras: None };
        Ok(Clip { index, reading, corrected, amended })
    }

    /// The name that is written must say what it will be.
    pub fn check_ending(&self, output: &Path) -> Result<(), Failure> {
        check_ending(output, self.kind)
    }

    /// The bytes of the corrected file.
    pub fn bytes(&self, clips: &[Clip], output: &Path) -> Result<Vec<u8>, Failure> {
        let Opened { file, source, options, .. } = self;
        let untouched = clips.iter().all(|clip| clip.amended.edits.is_empty() && clip.amended.speed == 1.0);
        let gltf_text = source.first() != Some(&b'g');
        if let (Some(parsed), Some(clip)) = (file.bvh(), clips.first()) {
            if untouched {
                return Ok(source.clone());
            }
            let text = bvh::decode(source);
            let edited = bvh_write::write(&text, parsed, &clip.amended.edits);
            let edited =
                if clip.amended.speed == 1.0 { edited } else { faster(&edited, 1.0 / clip.corrected.capture.fps) };
            return Ok(edited.into_bytes());
        }
        if untouched && !gltf_text {
            return Ok(source.clone());
        }
        let (Some(document), Some(nodes)) = (file.document(), file.nodes()) else {
            return Err(Failure::failed(format!("{}: this kind of file cannot be written", output.display())));
        };
        let mut amended: Vec<Amended> = clips.iter().map(|clip| clip.amended.clone()).collect();
        let failed = |error: crate::export::ExportError| Failure::failed(error.to_string());
        let bytes = amend(document, nodes, &amended).map_err(failed)?;
        // A clip that was baked here tells of itself as the written keys are.
        let said: Vec<Option<Value>> =
            clips.iter().map(|clip| told_again(document, clip, output, &bytes, options)).collect();
        if said.iter().all(Option::is_none) {
            return Ok(bytes);
        }
        for (amended, said) in amended.iter_mut().zip(said) {
            amended.extras = said;
        }
        amend(document, nodes, &amended).map_err(failed)
    }

    /// m: how far the written clip is from what was meant, frame by frame at its rate; `None` where it cannot be read again.
    pub fn off_by(&self, clip: &Clip, output: &Path, bytes: &[u8]) -> Option<f64> {
        let options = &self.options;
        let unit = options.unit.or(Some(clip.reading.capture.units_to_metres));
        let options = Options { unit, fps: Some(clip.corrected.capture.fps), ..options.clone() };
        let back = locals::read_back(&output.display().to_string(), bytes, clip.index, &options)?;
        Some(locals::written_off_by(&clip.corrected.capture, &back))
    }
}

/// The name that is written must say what it will be.
fn check_ending(output: &Path, kind: Kind) -> Result<(), Failure> {
    let ending = output.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
    let (may, what): (&[&str], &str) = match kind {
        Kind::Bvh => (&["bvh"], "a BVH clip is corrected as BVH"),
        Kind::Fbx => (&["glb"], "an FBX clip is corrected as GLB"),
        Kind::Gltf => (&["glb"], "a glTF clip is corrected as GLB"),
        Kind::Vrm => (&["vrm", "glb"], "a VRM stays one"),
        Kind::Vrma => (&["vrma", "glb"], "a VRM animation stays one"),
    };
    if may.contains(&ending.as_str()) {
        return Ok(());
    }
    Err(Failure::bad_input(format!("{}: {what}\n  help: let the name behind -o end in .{}", output.display(), may[0])))
}

/// What a clip tells from now on; `None` where it told nothing or nothing was changed.
fn told_again(document: &Document, clip: &Clip, output: &Path, bytes: &[u8], options: &Options) -> Option<Value> {
    if clip.amended.edits.is_empty() && clip.amended.speed == 1.0 {
        return None;
    }
    let said = document.list("animations").get(clip.index)?.pointer("/extras/surefoot")?;
    let dense = Options {
        unit: options.unit.or(Some(clip.reading.capture.units_to_metres)),
        fps: Some(clip.corrected.capture.fps * told::PER_FRAME as f64),
        ..options.clone()
    };
    let written = locals::read_back(&output.display().to_string(), bytes, clip.index, &dense)?;
    told::again(said, &clip.reading, &clip.corrected, &written)
}

/// The text with another frame time.
fn faster(text: &str, frame_time: f64) -> String {
    let Some(at) = text.to_ascii_lowercase().find("frame time:") else { return text.to_owned() };
    let rest = &text[at + "frame time:".len()..];
    let skipped = rest.len() - rest.trim_start().len();
    let number = rest.split_whitespace().next().map_or(0, str::len);
    let start = at + "frame time:".len() + skipped;
    format!("{}{frame_time:.9}{}", &text[..start], &text[start + number..])
}

#[cfg(test)]
mod tests {
    use super::faster;

    #[test]
    fn only_the_frame_time_becomes_another() {
        let text = "MOTION\nFrames: 2\nFrame Time:\t0.04\r\n1 2 3\n";
        assert_eq!(faster(text, 0.02), "MOTION\nFrames: 2\nFrame Time:\t0.020000000\r\n1 2 3\n");
        assert_eq!(faster("no motion", 0.02), "no motion");
    }
}
