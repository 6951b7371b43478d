//! Zero-lag low-pass filters of uniformly sampled series.
