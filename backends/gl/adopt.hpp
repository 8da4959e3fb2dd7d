// lumo inside a program that has an OpenGL context of its own. docs/porting.md walks through it.
#pragma once

#include "rhi/rhi.hpp"

namespace lumo::backends::gl {

/// A device of the context that is current on this thread, whoever made it: GLFW, SDL, Qt, plain EGL or GLX.
///
/// Required: OpenGL 4.5 or later, core profile; no extension. The context is current on this thread in each call of
/// the device and of what it made, the destruction of these included; it outlives the device.
///
/// State: between Device::begin and Device::submit the context is lumo's. After submit, and after every other call,
/// all state is as the host left it, but for what OpenGL lets nobody read: the host has no query, conditional
/// rendering or transform feedback running at begin; no program in use that is deleted already; extensions that
/// change how core commands draw are off.
/// Errors that the host has not read by glGetError go to the sink, as messages of severity low.
///
/// Textures: Device::adopt_texture takes a name whose storage is immutable. lumo reads and writes it through a view,
/// so neither its parameters nor its name are touched, and the host may delete the name while lumo has it. What either
/// side wrote to a texture or a buffer is visible to the other without a barrier.
///
/// Sync: with one context there is nothing to do. For work of another context of the share group, Commands::wait
/// takes a GLsync whose fence that context has flushed; for the other way, call glFenceSync after submit.
/// Commands::signal is not supported.
///
/// Messages: a debug callback of the host's stays, and hears of lumo's calls too. Where it has none, `desc.validation`
/// is set and the context is a debug one, messages go to `desc.sink` between begin and submit.
///
/// Errors: no_device, with what the context is instead, or what its device is where `desc.name` asks for another;
/// out_of_memory.
Result<rhi::Device> adopt_current_context(const rhi::DeviceDesc& desc = {});

}  // namespace lumo::backends::gl
