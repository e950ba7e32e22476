//! Stub.
fn main() { println!("{:?}", rigd::limits::Limits::default()); }
