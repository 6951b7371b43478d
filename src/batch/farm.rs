//! A batch as a job for a render farm: its variations in chunks that run anywhere in any order, then one run of the whole, which
//! finds all done and makes manifest and pictures. [`super::openjd`] and [`super::slurm`] write it for the farm's engine. No file is touched here.

/// What a farm needs to know.
#[derive(Clone, Debug, PartialEq)]
pub struct FarmJob {
    /// For a person.
    pub name: String,
    /// Variations.
    pub count: usize,
    /// Of them in a chunk; the last one has what is left.
    pub chunk: usize,
    /// The sweep's file: an absolute path.
    pub sweep: String,
    /// Every other file that is read (scenarios, rigs and what belongs to them, base clips): absolute paths.
    pub inputs: Vec<String>,
    /// The folder of the results: an absolute path.
    pub output: String,
    /// What the workers call the program: a name on their path, or a path.
    pub program: String,
    /// Flags for every run, as `--merge`.
    pub flags: Vec<String>,
    /// Roughly, of one core and a chunk.
    pub core_minutes: f64,
}

/// A file of the job: its name inside of the job's folder, its bytes, and whether it is a script to run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FarmFile {
    /// No folders in it.
    pub name: &'static str,
    /// UTF-8.
    pub bytes: Vec<u8>,
    /// To be made executable where files can be.
    pub script: bool,
}

impl FarmJob {
    /// The chunks: first and last variation, from 1, both in it.
    pub fn chunks(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let (count, size) = (self.count, self.chunk.max(1));
        (1..=count).step_by(size).map(move |first| (first, first.saturating_add(size - 1).min(count)))
    }

    /// How many there are.
    pub fn chunk_count(&self) -> usize {
        self.count.div_ceil(self.chunk.max(1))
    }

    /// s after which a chunk hangs: twenty times the estimate, and never under an hour.
    pub fn patience(&self) -> u64 {
        let estimate = self.core_minutes * 60.0 * 20.0;
        if estimate.is_finite() { estimate.clamp(3600.0, 7.0 * 86_400.0).ceil() as u64 } else { 86_400 }
    }

    /// The name on one line of at most so many letters.
    pub(super) fn title(&self, most: usize) -> String {
        let words: Vec<&str> = self.name.split(|letter: char| letter.is_control() || letter.is_whitespace()).collect();
        let title = words.into_iter().filter(|word| !word.is_empty()).collect::<Vec<&str>>().join(" ");
        let title: String = title.chars().take(most).collect();
        if title.is_empty() { "surefoot".to_owned() } else { title }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Paths with what shells and templates read as their own.
    pub(crate) fn job(count: usize, chunk: usize) -> FarmJob {
        FarmJob {
            name: "hit reactions".to_owned(),
            count,
            chunk,
            sweep: "/studio/hit reactions/it's $HOME `x`.toml".to_owned(),
            inputs: vec!["/studio/hit reactions/shove.toml".to_owned(), "/studio/rigs/hero.glb".to_owned()],
            output: "/studio/out \"new\"".to_owned(),
            program: "surefoot".to_owned(),
            flags: Vec::new(),
            core_minutes: 0.2,
        }
    }

    #[test]
    fn chunks_hold_every_variation_once_whatever_their_size() {
        for count in [0, 1, 2, 23, 24, 25, 288, 1000] {
            for size in [0, 1, 2, 7, 24, 288, 5000, usize::MAX] {
                let job = job(count, size);
                let all: Vec<usize> = job.chunks().flat_map(|(first, last)| first..=last).collect();
                assert_eq!(all, (1..=count).collect::<Vec<usize>>(), "{count} by {size}");
                assert_eq!(job.chunks().count(), job.chunk_count(), "{count} by {size}");
                assert!(job.chunks().all(|(first, last)| last - first < size.max(1)), "{count} by {size}");
            }
        }
    }

    #[test]
    fn patience_is_finite_whatever_the_estimate() {
        let patience = |core_minutes: f64| FarmJob { core_minutes, ..job(1, 1) }.patience();
        assert_eq!([0.0, 1.0, -3.0].map(patience), [3600; 3]);
        assert_eq!(patience(10.0), 12_000);
        assert_eq!([f64::INFINITY, f64::NAN].map(patience), [86_400; 2]);
        assert_eq!(patience(1e300), 7 * 86_400);
    }
}
