//! Testing support.
