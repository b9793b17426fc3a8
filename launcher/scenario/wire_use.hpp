// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/scenario/program.hpp"
#include "launcher/scenario/scenario.hpp"

#include <string>

namespace gridspace::launcher {

/// The link on which a process exchanges raw frames: its `link`, network A of its `prp`, or the only one of its host
/// that carries no IP, or the only one at all. Empty when that is not clear (check_raw_link says so).
[[nodiscard]] std::string raw_link(Scenario const& scenario, Process const& process);
void check_raw_link(Scenario const& scenario, Process const& process, config::Diagnostics& diagnostics);

/// What a process sends and receives, on every network that it is attached to (`prp`). It must have settings.
[[nodiscard]] std::vector<WireUse> frames_sent(Scenario const& scenario, Process const& process);
[[nodiscard]] std::vector<WireUse> frames_received(Scenario const& scenario, Process const& process);

/// Of a doubly attached process: that each frame that it sends has room for the redundancy control trailer.
void check_room_for_trailers(Scenario const& scenario, Process const& process, config::Diagnostics& diagnostics);

/// `wire:` of the settings of a process with raw frames: link, interface and MAC address of its port.
[[nodiscard]] config::Node wire_settings(Scenario const& scenario, Process const& process);

/// In lockstep a program sends samples at the simulator's steps only; the complaint is at `ref`, which names the
/// stream.
void check_samples_on_steps(Scenario const& scenario, streams::Stream const& stream, config::Ref const& ref,
                            config::Diagnostics& diagnostics);

/// The scenario's stream of this name and kind, with an error at `ref` when there is none.
[[nodiscard]] streams::Stream const* must_be_stream(Scenario const& scenario, config::Ref const& ref,
                                                    streams::Kind kind, config::Diagnostics& diagnostics);
/// The member of the data set must exist, and be a number or a Boolean; the complaint is at `ref`. No stream: nothing.
void must_have_member(streams::Stream const* stream, std::string const& member, config::Ref const& ref, bool boolean,
                      config::Diagnostics& diagnostics);
/// A stream on the link of a process.
[[nodiscard]] WireUse use_of(Scenario const& scenario, Process const& process, config::Ref const& stream);

/// Does any process exchange raw frames? Then the run needs network namespaces, or real interfaces.
[[nodiscard]] bool has_raw_frames(Scenario const& scenario);

} // namespace gridspace::launcher
