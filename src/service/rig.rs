//! `rig.*`.

use super::call::Call;
use super::describe;
use crate::formats::{File, FileRef};
use crate::protocol::rig::{LoadParams, RigDescription, RigFile, RigList, RigParams, RigSummary};
use crate::protocol::{Done, Fault, FieldFault, FieldPath};

/// Bytes of a rig's name: enough for a path-like scheme of any client's own.
const LONGEST_NAME: usize = 256;

impl Call {
    pub(super) fn load(&self, params: LoadParams) -> Result<RigSummary, Fault> {
        let LoadParams {
            name,
            files,
            replace,
        } = params;
        if let Some(name) = &name {
            check_name(name)?;
        }
        let files = files
            .into_iter()
            .enumerate()
            .map(|(index, file)| self.file_ref(index, file));
        let files: Vec<_> = files.collect::<Result<_, _>>()?;
        let loaded = self
            .engine()
            .load(name.as_deref(), &files, self.source(), replace)?;
        Ok(describe::summary(&loaded))
    }

    pub(super) fn unload(&self, params: &RigParams) -> Result<Done, Fault> {
        self.engine().unload(&params.rig)?;
        Ok(Done {})
    }

    pub(super) fn list(&self) -> RigList {
        RigList {
            rigs: self
                .engine()
                .rigs()
                .iter()
                .map(|loaded| describe::summary(loaded))
                .collect(),
        }
    }

    pub(super) fn describe(&self, params: &RigParams) -> Result<RigDescription, Fault> {
        Ok(describe::description(&self.engine().rig(&params.rig)?))
    }

    fn file_ref(&self, index: usize, file: RigFile) -> Result<FileRef, Fault> {
        // An inline file may be called anything. The first one's name becomes the rig's, and all of them stand in messages.
        let inline_name = match &file {
            RigFile::Path(_) => "",
            RigFile::Text { name, .. }
            | RigFile::Base64 { name, .. }
            | RigFile::Attached { name, .. } => name,
        };
        if inline_name.chars().any(char::is_control) {
            let problem = "expected a file name without control characters";
            return Err(FieldFault::new("name", problem)
                .within(("files", index))
                .into());
        }
        let inline = |name, bytes| Ok(FileRef::Inline(File { name, bytes }));
        match file {
            RigFile::Path(path) => Ok(FileRef::Path(path)),
            RigFile::Text { name, text } => inline(name, text.into_bytes().into()),
            RigFile::Base64 { name, base64 } => inline(name, base64.0.into()),
            RigFile::Attached { name, attach } => {
                let bytes = attach.of(&self.attached);
                let path = FieldPath::from(("files", index)).field("attach");
                inline(name, bytes.map_err(|fault| fault.within(path))?.into())
            }
        }
    }
}

fn check_name(name: &str) -> Result<(), Fault> {
    let problem = if name.is_empty() {
        "expected a name, but found an empty string".to_owned()
    } else if name.len() > LONGEST_NAME {
        format!(
            "expected at most {LONGEST_NAME} bytes, but found {}",
            name.len()
        )
    } else if name.chars().any(char::is_control) {
        "expected a name without control characters".to_owned()
    } else if name.starts_with("sha256:") {
        "expected a name that cannot be taken for a digest".to_owned()
    } else {
        return Ok(());
    };
    Err(Fault::invalid_params("name", problem))
}
