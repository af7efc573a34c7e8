//! The project itself: its layers, its words, its documents.
#![allow(clippy::unwrap_used, reason = "in tests a panic is the report")]

mod documents;
mod layers;
mod packages;
mod vocabulary;
