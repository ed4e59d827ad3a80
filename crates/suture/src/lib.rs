//! suture
