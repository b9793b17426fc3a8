// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/frame.hpp"
#include "gateways/prp/redundancy_trailer.hpp"

#include <array>
#include <memory>
#include <vector>

namespace gridspace::prp {

/// What came on a network (`cnt...` of a link redundancy entity, IEC 62439-3 clause 7).
struct LanCounters {
    std::uint64_t received{0};
    std::uint64_t first{0};     ///< of these passed on: the other copy was not here yet
    std::uint64_t wrong_lan{0}; ///< the trailer names the other network: cables are swapped, or the networks are joined
    std::uint64_t alone{0};     ///< without a trailer: from a singly attached node
};

/// Passes on the first copy of a frame and discards the second, by source address and sequence number (IEC 62439-3
/// clause 4.1.10). A genuine frame is never discarded: what cannot be told apart is passed on, and the protocols above
/// know duplicates. Memory is bounded: kSources addresses, the least recently heard gives way.
class DuplicateDiscard {
  public:
    static constexpr std::int64_t kForgetNs = 400'000'000; ///< EntryForgetTime: a sequence number begins anew after it
    static constexpr std::size_t kWindow = 4096;           ///< sequence numbers of a source that are remembered
    static constexpr std::size_t kSources = 64;

    /// A frame from the network `lan` at this time; false: its other copy has been passed on. Allocates with a new
    /// source only.
    bool accept(Octets frame, Lan lan, std::int64_t time_ns);
    [[nodiscard]] LanCounters const& counters(Lan lan) const { return lan == Lan::a ? a_ : b_; }

  private:
    struct Entry {
        std::int64_t time_ns{0};
        std::uint16_t sequence{0};
        std::uint8_t lans{0}; ///< on which it came; 0: empty
    };
    struct Source {
        iec61850::Mac mac;
        std::int64_t heard_ns{0};
        std::vector<Entry> entries;
    };
    Source& source(iec61850::Mac const& mac, std::int64_t time_ns);

    LanCounters a_, b_;
    std::vector<std::unique_ptr<Source>> sources_;
};

} // namespace gridspace::prp
