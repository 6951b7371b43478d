//! BVH (Biovision hierarchy) as text to joints and channel values. File units and axes; degrees become nothing here: values stay
//! as the file has them until [`Bvh::local`] reads a frame.
//!
//! Read by what files in the wild do, not by one program's habit: any order of channels, position channels on any joint (they
//! stand in the place of the offset), `End Site` with or without a name, numbers over several lines, tabs, CR LF, frame rates that are
//! not round. What is broken is told with its line. Leaves out several roots: the first is read, the rest is an error.

use super::MocapError;
use super::rate::MOST_FRAMES;
use crate::maths::real;
use crate::rig::Trs;
use glam::{DQuat, DVec3};
use std::borrow::Cow;

/// Joints, end sites among them, that are read at most.
const MOST_JOINTS: usize = 2_000;
/// Values of the motion that are read at most: 1 GiB of them.
const MOST_VALUES: usize = 1 << 27;
/// Beyond this a number is a broken file.
const FARTHEST: f64 = 1e7;

/// A file's bytes as text: UTF-8, or where they are not, every byte as the character of its number (Latin-1), so that [`encode`]
/// gives the same bytes back.
pub fn decode(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => Cow::Owned(bytes.iter().copied().map(char::from).collect()),
    }
}

/// The bytes of a text that was decoded from `original`.
pub fn encode(text: &str, original: &[u8]) -> Vec<u8> {
    if std::str::from_utf8(original).is_ok() {
        return text.as_bytes().to_vec();
    }
    text.chars().map(|letter| u8::try_from(u32::from(letter)).unwrap_or(b'?')).collect()
}

/// A parsed file.
#[derive(Clone, Debug)]
pub struct Bvh {
    /// Parents first; end sites are joints without channels.
    pub joints: Vec<Joint>,
    /// s.
    pub frame_time: f64,
    /// Channel values a frame.
    pub width: usize,
    /// (frames x width), as in the file: degrees and file units.
    pub values: Vec<f64>,
    /// Line of the first frame's first value, from 1.
    pub motion_line: usize,
    /// Byte at which the values begin.
    pub motion_byte: usize,
    /// Sentences for a person.
    pub notes: Vec<String>,
}

/// A joint or an end site.
#[derive(Clone, Debug)]
pub struct Joint {
    /// The file's name; an end site is its parent's with "_end".
    pub name: String,
    /// Index of the parent.
    pub parent: Option<usize>,
    /// File units, from the parent.
    pub offset: DVec3,
    /// In the file's order.
    pub channels: Vec<Axis>,
    /// Index of its first channel in a frame.
    pub first: usize,
    /// An end site.
    pub end: bool,
}

/// What a channel says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axis {
    /// Position along x, y or z (0, 1, 2), file units.
    Position(usize),
    /// Turn about x, y or z (0, 1, 2), degrees.
    Rotation(usize),
}

impl Bvh {
    /// Reads a file's text. `file` is its name in messages.
    pub fn parse(file: &str, text: &str) -> Result<Bvh, MocapError> {
        let mut words = Words { text, at: 0, line: 1 };
        let fault = |line: usize, what: String| MocapError::Malformed {
            file: file.to_owned(),
            place: format!("line {line}"),
            what,
        };
        words.expect("HIERARCHY").map_err(|(line, what)| fault(line, what))?;
        let (joints, width) = hierarchy(&mut words).map_err(|(line, what)| fault(line, what))?;
        let mut bvh = Bvh {
            joints,
            frame_time: 0.0,
            width,
            values: Vec::new(),
            motion_line: 0,
            motion_byte: 0,
            notes: Vec::new(),
        };
        motion(&mut words, &mut bvh).map_err(|(line, what)| fault(line, what))?;
        Ok(bvh)
    }

    /// Frames.
    pub fn frames(&self) -> usize {
        self.values.len().checked_div(self.width).unwrap_or(0)
    }

    /// A joint's transform relative to its parent, file units.
    pub fn local(&self, frame: usize, joint: usize) -> Trs {
        let row = &self.values[frame * self.width..(frame + 1) * self.width];
        let joint = &self.joints[joint];
        let mut translation = joint.offset;
        let mut rotation = DQuat::IDENTITY;
        for (channel, value) in joint.channels.iter().zip(&row[joint.first..]) {
            match channel {
                Axis::Position(axis) => translation[*axis] = *value,
                Axis::Rotation(axis) => {
                    let half = 0.5 * value.to_radians();
                    let mut turn = [0.0, 0.0, 0.0, real::cos(half)];
                    turn[*axis] = real::sin(half);
                    rotation *= DQuat::from_array(turn);
                }
            }
        }
        Trs { translation, rotation, scale: DVec3::ONE }
    }
}

type Fault = (usize, String);

fn hierarchy(words: &mut Words) -> Result<(Vec<Joint>, usize), Fault> {
    let mut joints: Vec<Joint> = Vec::new();
    let mut open: Vec<usize> = Vec::new(); // joints whose brace is open
    let mut width = 0;
    loop {
        let (line, word) = words.next().ok_or((words.line, "the file ends inside of the hierarchy".to_owned()))?;
        let upper = word.to_ascii_uppercase();
        match upper.as_str() {
            "ROOT" | "JOINT" | "END" => {
                if (upper == "ROOT") != open.is_empty() {
                    let what = if upper == "ROOT" { "a ROOT inside of a joint" } else { "a joint outside of a ROOT" };
                    return Err((line, what.to_owned()));
                }
                if upper == "ROOT" && !joints.is_empty() {
                    return Err((line, "a second ROOT: give each figure a file of its own".to_owned()));
                }
                let rest = words.rest_of_line_to_brace();
                let end = upper == "END";
                let name = match (end, open.last()) {
                    (true, Some(parent)) => format!("{}_end", joints[*parent].name),
                    _ if rest.is_empty() => return Err((line, format!("{word} without a name"))),
                    _ => rest.to_owned(),
                };
                words.expect("{")?;
                if joints.len() >= MOST_JOINTS {
                    return Err((line, format!("over {MOST_JOINTS} joints")));
                }
                let parent = open.last().copied();
                open.push(joints.len());
                joints.push(Joint { name, parent, offset: DVec3::ZERO, channels: Vec::new(), first: width, end });
            }
            "OFFSET" => {
                let joint = *open.last().ok_or((line, "OFFSET outside of a joint".to_owned()))?;
                joints[joint].offset = DVec3::new(words.number()?, words.number()?, words.number()?);
            }
            "CHANNELS" => {
                let joint = *open.last().ok_or((line, "CHANNELS outside of a joint".to_owned()))?;
                let count = words.number()?;
                if !(0.0..=9.0).contains(&count) || count.fract() != 0.0 {
                    return Err((line, format!("{count} channels: 0 to 9 can be read")));
                }
                if !joints[joint].channels.is_empty() || joints[joint].end {
                    return Err((line, "CHANNELS where there can be none: an end site, or a second time".to_owned()));
                }
                joints[joint].first = width;
                for _ in 0..count as usize {
                    let (line, word) = words.next().ok_or((words.line, "the file ends in CHANNELS".to_owned()))?;
                    let axis = axis(word).ok_or_else(|| {
                        (
                            line,
                            format!("{word:?} is no channel: Xposition to Zrotation are, and so many as are announced"),
                        )
                    })?;
                    joints[joint].channels.push(axis);
                }
                width += count as usize;
            }
            "}" => {
                open.pop().ok_or((line, "a } too many".to_owned()))?;
            }
            "MOTION" if open.is_empty() && !joints.is_empty() => return Ok((joints, width)),
            "MOTION" => return Err((line, "MOTION before the hierarchy is closed: a } is missing".to_owned())),
            _ => return Err((line, format!("{word:?}: expected ROOT, JOINT, End Site, OFFSET, CHANNELS or a brace"))),
        }
    }
}

fn axis(word: &str) -> Option<Axis> {
    let word = word.to_ascii_lowercase();
    let axis = match word.as_bytes().first()? {
        b'x' => 0,
        b'y' => 1,
        b'z' => 2,
        _ => return None,
    };
    match &word[1..] {
        "position" => Some(Axis::Position(axis)),
        "rotation" => Some(Axis::Rotation(axis)),
        _ => None,
    }
}

fn motion(words: &mut Words, bvh: &mut Bvh) -> Result<(), Fault> {
    words.expect("Frames:")?;
    let line = words.line;
    let announced = words.number()?;
    if !(announced >= 1.0 && announced.fract() == 0.0) {
        return Err((line, format!("{announced} frames: there must be one at least")));
    }
    words.expect("Frame")?;
    words.expect("Time:")?;
    let line = words.line;
    bvh.frame_time = words.number()?;
    if !(1e-4..=10.0).contains(&bvh.frame_time) {
        return Err((line, format!("a frame time of {} s: 0.0001 to 10 can be read", bvh.frame_time)));
    }
    if bvh.width == 0 {
        return Err((line, "no joint has a channel: nothing moves".to_owned()));
    }
    let wanted = announced * bvh.width as f64;
    if wanted > MOST_VALUES as f64 || announced > MOST_FRAMES as f64 {
        return Err((line, format!("{announced} frames of {} values are too many", bvh.width)));
    }
    let wanted = wanted as usize;
    words.skip_blank();
    (bvh.motion_line, bvh.motion_byte) = (words.line, words.at);
    // No more room than the text can fill: a value is a digit and a blank at least.
    bvh.values.reserve(wanted.min((words.text.len() - words.at) / 2 + 1));
    while bvh.values.len() < wanted {
        if words.at_end() {
            let (whole, width) = (bvh.values.len() / bvh.width, bvh.width);
            return Err((
                words.line,
                format!(
                    "the file ends in frame {whole} of {announced} ({} of its {width} values): it was cut off; \
                     export it again, or write the number of whole frames, {whole}, behind Frames:",
                    bvh.values.len() % width
                ),
            ));
        }
        bvh.values.push(words.number()?);
    }
    if let Some((line, word)) = words.next() {
        if word.parse::<f64>().is_err() {
            return Err((line, format!("{word:?} behind the last frame")));
        }
        bvh.notes.push(format!("line {line}: more values than the {announced} frames that are announced; left out"));
    }
    Ok(())
}

/// The text's words, with their lines.
struct Words<'a> {
    text: &'a str,
    at: usize,
    line: usize,
}

impl<'a> Words<'a> {
    fn skip_blank(&mut self) {
        let bytes = self.text.as_bytes();
        while let Some(byte) = bytes.get(self.at) {
            match byte {
                b'\n' => self.line += 1,
                b' ' | b'\t' | b'\r' | 0xEF | 0xBB | 0xBF => {} // a byte order mark is blank too
                _ => break,
            }
            self.at += 1;
        }
    }

    fn at_end(&mut self) -> bool {
        self.skip_blank();
        self.at >= self.text.len()
    }

    fn next(&mut self) -> Option<(usize, &'a str)> {
        self.skip_blank();
        let bytes = self.text.as_bytes();
        let start = self.at;
        if matches!(bytes.get(start), Some(b'{' | b'}')) {
            self.at += 1;
        } else {
            while bytes.get(self.at).is_some_and(|byte| !matches!(byte, b' ' | b'\t' | b'\r' | b'\n' | b'{' | b'}')) {
                self.at += 1;
            }
        }
        let word = self.text.get(start..self.at)?;
        (!word.is_empty()).then_some((self.line, word))
    }

    fn expect(&mut self, wanted: &str) -> Result<(), Fault> {
        match self.next() {
            Some((_, word)) if word.eq_ignore_ascii_case(wanted) => Ok(()),
            Some((line, word)) => Err((line, format!("expected {wanted}, found {:?}", shortened(word)))),
            None => Err((self.line, format!("the file ends where {wanted} should be"))),
        }
    }

    fn number(&mut self) -> Result<f64, Fault> {
        let (line, word) = self.next().ok_or((self.line, "the file ends where a number should be".to_owned()))?;
        match word.parse::<f64>() {
            Ok(number) if number.abs() <= FARTHEST => Ok(number),
            _ => Err((line, format!("{:?} is no number that can be used", shortened(word)))),
        }
    }

    /// What stands on the line up to a brace: names may have blanks.
    fn rest_of_line_to_brace(&mut self) -> &'a str {
        let rest = &self.text[self.at..];
        let end = rest.find(['\n', '{']).unwrap_or(rest.len());
        self.at += end;
        rest[..end].trim()
    }
}

fn shortened(word: &str) -> String {
    word.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMALL: &str = "HIERARCHY\r\nROOT Hips\n{\n OFFSET 0 0 0\n CHANNELS 6 Zrotation Xrotation Yrotation Xposition Yposition Zposition\n\
        JOINT Left Leg\n{ OFFSET 1 -2 0\n CHANNELS 3 Xrotation Yrotation Zrotation\n End Site\n { OFFSET 0 -3 0 } } }\n\
        MOTION\nFrames: 2\nFrame Time: 0.04\n90 0 0 1 2 3\n 0 90 0\n0 0 0 4 5 6 0 0 0\n";

    #[test]
    fn rotations_come_in_the_order_of_the_channels_and_positions_where_they_stand() {
        let bvh = Bvh::parse("small.bvh", SMALL).expect("a file");
        assert_eq!((bvh.frames(), bvh.width, bvh.joints.len()), (2, 9, 3));
        assert_eq!((bvh.joints[1].name.as_str(), bvh.joints[2].name.as_str()), ("Left Leg", "Left Leg_end"));
        let root = bvh.local(0, 0);
        assert_eq!(root.translation, DVec3::new(1.0, 2.0, 3.0));
        assert!((root.rotation * DVec3::X - DVec3::Y).length() < 1e-12, "Z first: X becomes Y");
        assert_eq!(bvh.local(0, 1).translation, DVec3::new(1.0, -2.0, 0.0));
        assert!((bvh.local(0, 1).rotation * DVec3::Z - DVec3::X).length() < 1e-12);
        assert_eq!(bvh.local(1, 0).translation.x, 4.0);
    }

    #[test]
    fn what_is_broken_is_told_with_its_line() {
        let broken =
            |from: &str, to: &str| Bvh::parse("f.bvh", &SMALL.replacen(from, to, 1)).expect_err(to).to_string();
        assert!(broken("90 0 0", "90 nan 0").contains("f.bvh: line 14"), "{}", broken("90 0 0", "90 nan 0"));
        assert!(broken("4 5 6 0 0 0", "4 5 6").contains("frame 1 of 2 (6 of its 9"), "cut off");
        assert!(broken("Frames: 2", "Frames: 9999999").contains("too many"));
        assert!(broken("Frames: 2", "Frames: 9e99").contains("no number that can be used"));
        assert!(broken("Frames: 2", "Frames: -1").contains("one at least"));
        assert!(broken("0.04", "0").contains("frame time"));
        assert!(broken("CHANNELS 3", "CHANNELS 4").contains("no channel"));
        assert!(broken("} } }", "} }").contains("} is missing"));
        assert!(broken("HIERARCHY", "<html>").contains("expected HIERARCHY"));
    }
}
