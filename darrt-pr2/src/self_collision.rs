//! self_collision.
