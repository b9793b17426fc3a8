// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

/// How large things are that are drawn.
namespace gridspace::diagram {

// Lengths in the units of the drawing, which are pixels on a wide screen.
inline constexpr double kDeviceRow = 25, kStub = 14, kTagRow = 18, kFaultRow = 12, kValueRow = 12, kValueRoom = 64;

/// What hangs on a bus, as it is drawn: what is in no list is an arrow.
enum class DeviceShape { source, circle, store, arrow };
[[nodiscard]] DeviceShape shape_of(std::string_view kind);
/// From the end of its stub to its label; and what is kept free behind that for live values.
[[nodiscard]] double label_offset(DeviceShape shape);
[[nodiscard]] double room_of(DeviceShape shape);

/// How wide a text of 12 (a name) or 11 is at most, with the usual sans-serif fonts.
[[nodiscard]] double width_of(std::string_view text);

} // namespace gridspace::diagram
