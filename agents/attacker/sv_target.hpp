// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/sv_layout.hpp"
#include "gateways/streams/stream.hpp"

#include <algorithm>
#include <string>

namespace gridspace::attacker {

/// The stream of sampled values that is attacked, as its frames show it. No allocation per frame.
class SvTarget {
  public:
    explicit SvTarget(streams::Stream const& stream) : sv_id_{stream.sv_id}, layout_{stream.data_set} {}

    /// Whether it is a frame with samples of this stream and no other; then it is in `out`.
    [[nodiscard]] bool decode(iec61850::Octets frame, iec61850::SvFrame& out) const {
        if (!iec61850::decode_sv(frame, out)) {
            return false;
        }
        auto const asdus = out.view();
        return !asdus.empty() && std::all_of(asdus.begin(), asdus.end(), [&](iec61850::Asdu const& a) {
            return a.sv_id == sv_id_ && a.sample.size() == layout_.sample_octets();
        });
    }
    [[nodiscard]] iec61850::SvLayout const& layout() const { return layout_; }
    /// A, of one count of a slot: integers count milliamperes.
    [[nodiscard]] double amperes(std::size_t slot) const {
        return iec61850::is_integer(layout_.slots()[slot].leaf.type) ? 1e-3 : 1.0;
    }

  private:
    std::string sv_id_;
    iec61850::SvLayout layout_;
};

} // namespace gridspace::attacker
