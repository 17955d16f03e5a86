//! Pipelines of a pass, by key.

use std::collections::HashMap;
use std::fmt::Debug;
use std::hash::Hash;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use haze_core::error::{PrepareError, one_line};

use super::gpu::binding::{bind_group_layout, bind_resources};
use super::gpu::error_scopes::with_error_scopes;
use super::gpu::pipeline::{Common, PipelineDescription, PipelineStore, Shader};
use super::layouts::{GroupSet, Layouts};

/// Declaration of a pass's pipelines, in its file: the key that tells them apart implements it.
pub(crate) trait PipelineKey: Copy + Debug + Eq + Hash {
    /// Name of the pass: of its shader, and in times and captures.
    const PASS: &'static str;
    /// Bind groups that the pass shares with others. They come before its own.
    const GROUPS: GroupSet;
    type Description: PipelineDescription;

    /// Returns the types of the bindings of the pass's own bind group. Without any, it has no such group.
    fn inputs() -> Vec<wgpu::BindingType> {
        Vec::new()
    }

    /// Returns the parts in which the pipeline of this key differs from others of the pass.
    fn describe(self) -> Self::Description;
}

/// Shader of a pass, and its pipelines by key. A pipeline is compiled on first use, from any thread.
#[derive(Debug)]
pub(crate) struct PipelineVariants<K: PipelineKey> {
    common: Common,
    /// Layout of the pass's own bind group.
    pub inputs: wgpu::BindGroupLayout,
    /// Shared by contexts with the same module.
    pipelines: Arc<Mutex<HashMap<K, PipelineOf<K>>>>,
}

type PipelineOf<K> = <<K as PipelineKey>::Description as PipelineDescription>::Pipeline;

impl<K: PipelineKey> PipelineVariants<K> {
    pub fn new(store: &PipelineStore, layouts: &Layouts, shader: Shader) -> Self {
        Self::with_inputs(store, &layouts.groups(K::GROUPS), shader, &K::inputs())
    }

    /// As [`new`](Self::new), for a pass whose own bind group is not always of the same types. `groups`: layouts of the
    /// groups before it.
    pub fn with_inputs(
        store: &PipelineStore,
        groups: &[&wgpu::BindGroupLayout],
        shader: Shader,
        types: &[wgpu::BindingType],
    ) -> Self {
        let inputs = bind_group_layout(&store.device, &inputs_label(K::PASS), K::Description::STAGES, types);
        let own = Some(&inputs).filter(|_| !types.is_empty());
        let groups: Vec<_> = groups.iter().copied().chain(own).map(Some).collect();
        let layout = store.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(K::PASS),
            bind_group_layouts: &groups,
            immediate_size: 0,
        });
        let common = Common { name: K::PASS, shader, layout, store: store.clone() };
        Self { common, inputs, pipelines: Arc::default() }
    }

    /// Creates the pass's own bind group.
    pub fn bind<'a>(&self, resources: impl IntoIterator<Item = wgpu::BindingResource<'a>>) -> wgpu::BindGroup {
        bind_resources(&self.common.store.device, &inputs_label(K::PASS), &self.inputs, resources)
    }

    /// Creates the pass's own bind group, of textures alone.
    pub fn bind_textures<'a>(&self, views: impl IntoIterator<Item = &'a wgpu::TextureView>) -> wgpu::BindGroup {
        self.bind(views.into_iter().map(wgpu::BindingResource::TextureView))
    }

    /// Shares the pipelines of another context if its module is the same.
    pub fn share(&mut self, other: &Self) {
        if self.common.shader.is_same(&other.common.shader) {
            self.pipelines = other.pipelines.clone();
        }
    }

    /// Returns the pipeline for `key`; compiles it on first use. The lock is not held during compilation, so other
    /// threads do not wait.
    pub fn get(&self, key: K) -> PipelineOf<K> {
        let found = self.lock().get(&key).cloned();
        found.unwrap_or_else(|| self.keep(key, self.compile(key)))
    }

    /// Compiles the pipeline for `key`, or returns the shader error.
    pub fn check(&self, key: K) -> Result<(), PrepareError> {
        if self.lock().contains_key(&key) {
            return Ok(());
        }
        let compiled = with_error_scopes(&self.common.store.device, || self.compile(key)).map_err(|reason| {
            let stages = [("VERTEX", "vertex"), ("FRAGMENT", "fragment"), ("COMPUTE", "compute")];
            let plain = |text: String, (stage, name): (&str, _)| text.replace(&format!("ShaderStages({stage})"), name);
            let reason = one_line(stages.into_iter().fold(reason, plain));
            PrepareError::Shader { path: self.common.shader.path.clone(), line: 1, column: 1, reason }
        })?;
        self.keep(key, compiled);
        Ok(())
    }

    /// Stores a compiled pipeline, unless another thread stored one first; returns the stored one.
    fn keep(&self, key: K, compiled: PipelineOf<K>) -> PipelineOf<K> {
        let store = &self.common.store;
        let stored = |compiled| {
            store.count_pipeline();
            compiled
        };
        self.lock().entry(key).or_insert_with(|| stored(compiled)).clone()
    }

    fn lock(&self) -> MutexGuard<'_, HashMap<K, PipelineOf<K>>> {
        self.pipelines.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn compile(&self, key: K) -> PipelineOf<K> {
        key.describe().create(&self.common)
    }
}

/// Label of a pass's own bind group.
fn inputs_label(pass: &str) -> String {
    format!("haze {pass} inputs")
}

/// Defines a set of pipelines: the pipelines of each pass by name, and their key.
macro_rules! pipeline_set {
    ($(#[$attribute:meta])* $visibility:vis $set:ident { $($pass:ident: $key:ty,)+ }) => {
        $(#[$attribute])*
        #[derive(Debug)]
        $visibility struct $set {
            $(pub $pass: $crate::renderer::pipeline_variants::PipelineVariants<$key>,)+
        }

        impl $set {
            /// Composes the shaders and creates pipeline layouts. `shader` returns the shader of a pass by name.
            fn new<E>(
                store: &$crate::renderer::gpu::pipeline::PipelineStore,
                layouts: &$crate::renderer::layouts::Layouts,
                shader: impl Fn(&'static str) -> Result<$crate::renderer::gpu::pipeline::Shader, E>,
            ) -> Result<Self, E> {
                Ok(Self {
                    $($pass: {
                        let shader = shader(<$key as $crate::renderer::pipeline_variants::PipelineKey>::PASS)?;
                        $crate::renderer::pipeline_variants::PipelineVariants::new(store, layouts, shader)
                    },)+
                })
            }

            /// Shares the pipelines of another context of the device that have the same module.
            fn share(&mut self, other: &Self) {
                $(self.$pass.share(&other.$pass);)+
            }
        }
    };
}
pub(crate) use pipeline_set;
