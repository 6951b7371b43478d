//! Pictures as bytes: contact sheets.
