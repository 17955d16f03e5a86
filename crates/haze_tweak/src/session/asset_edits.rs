//! Ramps and sprites that are edited: copied, baked, simulated and written as the preset changes.

use super::{CopiedImage, CopyRequest, Session};

impl Session {
    /// Makes the requested copy: at once, or as soon as a built-in preset is saved.
    pub fn confirm_copy(&mut self) {
        let is_built_in = self.document.is_built_in();
        match self.copy_request.take() {
            Some(CopyRequest { system, image: CopiedImage::Ramp(field), .. }) => {
                self.ramps.request_copy(system, field, is_built_in);
            }
            Some(CopyRequest { system, image: CopiedImage::Sprite, name }) => {
                self.sprites.request_copy(system, &name, is_built_in);
            }
            None => {}
        }
    }

    /// Forgets copies, and a simulation, that wait until the preset is saved.
    pub fn cancel_copies(&mut self) {
        self.ramps.cancel_copy();
        self.sprites.cancel_copy();
        self.simulation.cancel_bake();
    }

    /// Bakes edited ramps, and writes them unless a control is held.
    pub fn follow_ramps(&mut self, is_held: bool) {
        let folders = self.folders();
        let mut done = self.ramps.advance(&mut self.document, &folders, is_held);
        if !is_held && done.is_ok() {
            done = self.ramps.write_requested_copy(&mut self.document);
        }
        if let Some(name) = self.ramps.replaced.take() {
            let problem = format!("Another program changed {name}, so its stops can no longer be edited");
            self.messages.info("ramp", format!("{problem}. Fit stops to the new image to edit it here."));
        }
        if let Err(error) = done {
            self.messages.error("ramp", error);
        }
    }

    /// Requests bakes of edited sprites; they are full and written unless a control is held.
    pub(super) fn follow_sprites(&mut self, is_held: bool) {
        let mut done = self.sprites.advance(&mut self.document, is_held);
        if !is_held && done.is_ok() {
            done = self.sprites.write_requested_copy(&mut self.document);
        }
        if let Err(error) = done {
            self.messages.error("sprite", error);
        }
    }

    /// Simulates an edited recipe at a low resolution, and writes the full one.
    pub(super) fn follow_simulation(&mut self, is_held: bool) {
        let wake = self.repaint.clone();
        match self.simulation.advance(&mut self.document, is_held, move || wake.call()) {
            Ok(Some(name)) => self.messages.info("simulation", format!("Wrote {name}, which this system now uses")),
            Ok(None) => {}
            Err(error) => self.messages.error("simulation", error),
        }
    }
}
