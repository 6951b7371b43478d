//! Poses to keys: the grid, the contact edges, bisection where a planted foot would slip, reduction everywhere else.
