//! A simulation under way as a file, from which it goes on to the same bytes.

use glam::{UVec3, Vec2};
use half::f16;

use super::grid::{CellBox, Grid};
use super::recorded_frame::{Extent, RecordedFrame};
use super::sim_recipe::SimRecipe;
use super::simulate::Simulation;
use crate::bytes::Bytes;

/// First bytes of a file. The number is that of the format.
const SIGNATURE: &[u8] = b"haze simulation 1\n";

/// Contents of a file after the signature: numbers, little-endian, compressed by LZ4.
struct CheckpointWriter(Vec<u8>);

struct CheckpointReader<'a>(Bytes<'a>);

impl CheckpointWriter {
    fn add<T: bytemuck::NoUninit>(&mut self, values: &[T]) {
        let packed = lz4_flex::block::compress(bytemuck::cast_slice(values));
        self.add_bytes(&packed);
    }

    fn add_bytes(&mut self, bytes: &[u8]) {
        self.0.extend_from_slice(&(bytes.len() as u32).to_le_bytes());
        self.0.extend_from_slice(bytes);
    }

    fn add_box(&mut self, cells: CellBox) {
        self.add(&[cells.low, cells.high]);
    }
}

impl CheckpointReader<'_> {
    /// Reads as many values as `values` has.
    fn read<T: bytemuck::AnyBitPattern + bytemuck::NoUninit>(&mut self, values: &mut [T]) -> Result<(), String> {
        let bytes = bytemuck::cast_slice_mut(values);
        let size = bytes.len();
        match lz4_flex::block::decompress_into(self.0.sized()?, bytes) {
            Ok(found) if found == size => Ok(()),
            _ => Err(format!("damaged; expected {size} bytes in LZ4")),
        }
    }

    fn read_one<T: bytemuck::AnyBitPattern + bytemuck::NoUninit + Default>(&mut self) -> Result<T, String> {
        let mut value = [T::default()];
        self.read(&mut value)?;
        let [value] = value;
        Ok(value)
    }

    /// Reads a box of cells, which may be empty.
    fn read_box(&mut self, grid: Grid) -> Result<CellBox, String> {
        let mut corners = [UVec3::ZERO; 2];
        self.read(&mut corners)?;
        let [low, high] = corners;
        let cells = CellBox { low, high };
        if cells.is_empty() {
            return Ok(CellBox::EMPTY);
        }
        let is_inside = low.cmpge(UVec3::ONE).all() && high.cmple(grid.size).all();
        is_inside.then_some(cells).ok_or_else(|| format!("damaged; expected cells of {}", grid.size))
    }
}

impl<'a> Simulation<'a> {
    /// Returns a file from which [`Self::resume`] goes on.
    pub fn to_checkpoint(&self) -> Vec<u8> {
        let mut writer = CheckpointWriter(SIGNATURE.to_vec());
        writer.add_bytes(&recipe_bytes(self.recipe));
        let fluid = &self.fluid;
        writer.add(&[self.warm_up_steps, self.finished_moments()]);
        writer.add(&[fluid.time]);
        writer.add_box(fluid.occupied);
        fluid.velocity.iter().for_each(|faces| writer.add(faces));
        writer.add(&fluid.centered);
        writer.add(&fluid.gas);
        writer.add(&fluid.solver.pressure);
        for frame in &self.frames {
            writer.add_box(frame.cells);
            writer.add(&[frame.extent.low, frame.extent.high]);
            writer.add(&frame.values);
        }
        writer.0
    }

    /// Goes on from the file that [`Self::to_checkpoint`] returned; `None` if that is of another recipe.
    ///
    /// # Errors
    /// The reason, without the file, if it is no checkpoint or is damaged, or if the recipe is not valid.
    pub fn resume(recipe: &'a SimRecipe, checkpoint: &[u8]) -> Result<Option<Self>, String> {
        let mut bytes = Bytes::starting_at(checkpoint, 0)?;
        if checkpoint.get(..SIGNATURE.len()) != Some(SIGNATURE) {
            return Err("no checkpoint of this version of haze".into());
        }
        bytes.take(SIGNATURE.len())?;
        if bytes.sized()? != recipe_bytes(recipe) {
            return Ok(None);
        }
        let mut reader = CheckpointReader(bytes);
        let mut simulation = Self::new(recipe).map_err(|error| error.to_string())?;
        let mut counts = [0_u32; 2];
        reader.read(&mut counts)?;
        let [warm_up_steps, moments] = counts;
        if moments > recipe.moment_count() {
            return Err(format!("damaged; expected at most {} frames", recipe.moment_count()));
        }
        simulation.warm_up_steps = warm_up_steps;
        let fluid = &mut simulation.fluid;
        fluid.time = reader.read_one()?;
        fluid.occupied = reader.read_box(fluid.fine.grid)?;
        fluid.velocity.iter_mut().try_for_each(|faces| reader.read(faces))?;
        reader.read(&mut fluid.centered)?;
        reader.read(&mut fluid.gas)?;
        reader.read(&mut fluid.solver.pressure)?;
        for _ in 0..moments {
            let cells = reader.read_box(fluid.fine.grid)?;
            let mut corners = [Vec2::ZERO; 2];
            reader.read(&mut corners)?;
            let [low, high] = corners;
            let mut frame = RecordedFrame { cells, values: Vec::new(), extent: Extent { low, high } };
            if !cells.is_empty() {
                frame.values.resize(frame.grid().cells(), [f16::ZERO; 4]);
            }
            reader.read(&mut frame.values)?;
            simulation.frames.push(frame);
        }
        Ok(Some(simulation))
    }
}

/// The recipe in the form in which two are compared.
fn recipe_bytes(recipe: &SimRecipe) -> Vec<u8> {
    // Never the default: a recipe has neither maps with other keys than text nor numbers that JSON lacks.
    serde_json::to_vec(recipe).unwrap_or_default()
}
