//! Curves in time: smooth steps, quintics, Bezier.
