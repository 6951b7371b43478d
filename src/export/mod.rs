//! Clips as bytes: the source document with an animation appended, events beside it.
