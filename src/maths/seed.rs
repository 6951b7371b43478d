//! The seeded generator: the only source of chance in the program. Same seed, same numbers, on every machine.
//!
//! SplitMix64 (Steele, Lea, Flood 2014): one word of state, passes the usual batteries, and a stream can be split off
//! by name so that adding a draw in one place does not shift those of another.

/// A stream of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seed(u64);

impl Seed {
    /// The stream of that seed.
    pub fn new(seed: u64) -> Seed {
        Seed(seed)
    }

    /// Another stream, fixed by this one's seed and the number, that does not disturb this one.
    pub fn split(self, number: u64) -> Seed {
        Seed(mix(self.0 ^ mix(number.wrapping_add(0x9e37_79b9_7f4a_7c15))))
    }

    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mix(self.0)
    }

    /// Evenly spread in 0..1, 1 left out.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Evenly spread in `low..high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

fn mix(word: u64) -> u64 {
    let word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    word ^ (word >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gives_the_published_numbers_of_seed_zero() {
        let mut seed = Seed::new(0);
        assert_eq!(seed.bits(), 0xe220_a839_7b1d_cdaf);
        assert_eq!(seed.bits(), 0x6e78_9e6a_a1b9_65f4);
    }

    #[test]
    fn draws_fill_the_range_evenly() {
        let mut seed = Seed::new(7);
        let mut bins = [0_u32; 10];
        for _ in 0..10_000 {
            let draw = seed.between(-2.0, 3.0);
            assert!((-2.0..3.0).contains(&draw));
            bins[((draw + 2.0) * 2.0) as usize] += 1;
        }
        assert!(bins.iter().all(|&count| (850..1150).contains(&count)), "{bins:?}");
    }

    #[test]
    fn a_split_stream_differs_and_leaves_its_parent_alone() {
        let parent = Seed::new(3);
        let (mut one, mut two) = (parent.split(1), parent.split(2));
        assert_ne!(one.bits(), two.bits());
        assert_eq!(parent, Seed::new(3));
    }
}
