//! postures.
