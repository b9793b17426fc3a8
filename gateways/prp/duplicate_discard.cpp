// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/prp/duplicate_discard.hpp"

#include <algorithm>
#include <cstring>

namespace gridspace::prp {

DuplicateDiscard::Source& DuplicateDiscard::source(iec61850::Mac const& mac, std::int64_t time_ns) {
    auto found = std::ranges::find_if(sources_, [&](auto const& s) { return s->mac == mac; });
    if (found == sources_.end()) {
        if (sources_.size() < kSources) {
            sources_.push_back(std::make_unique<Source>());
            sources_.back()->entries.resize(kWindow);
            found = sources_.end() - 1;
        } else {
            found = std::ranges::min_element(sources_, {}, [](auto const& s) { return s->heard_ns; });
            std::ranges::fill((*found)->entries, Entry{});
        }
        (*found)->mac = mac;
    }
    (*found)->heard_ns = time_ns;
    return **found;
}

bool DuplicateDiscard::accept(Octets frame, Lan lan, std::int64_t time_ns) {
    LanCounters& counters = lan == Lan::a ? a_ : b_;
    ++counters.received;
    auto const trailer = trailer_of(frame);
    if (!trailer) {
        ++counters.alone;
        return true;
    }
    counters.wrong_lan += trailer->lan != lan ? 1 : 0;
    iec61850::Mac mac;
    std::memcpy(mac.octets.data(), &frame[mac.octets.size()], mac.octets.size());
    Entry& entry = source(mac, time_ns).entries[trailer->sequence % kWindow];
    auto const bit = static_cast<std::uint8_t>(lan == Lan::a ? 1 : 2);
    bool const known = entry.lans != 0 && entry.sequence == trailer->sequence && time_ns - entry.time_ns < kForgetNs;
    if (known && (entry.lans & bit) == 0) {
        entry.lans |= bit;
        return false;
    }
    // New, or the same again on the same network, which is none of this protocol's business.
    if (!known) {
        entry = {time_ns, trailer->sequence, bit};
        ++counters.first;
    }
    return true;
}

} // namespace gridspace::prp
