// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::lockstep {

/// What identifies a frame on its link: FNV-1a (64 bit) over its octets from the destination address on, a VLAN tag
/// left out, because the kernel takes it off and puts it back.
[[nodiscard]] std::uint64_t frame_identity(std::span<std::byte const> frame);

/// Compares the raw frames that others say they have sent with those that have arrived. A wire knows no writer, so a
/// frame is recognised by what is in it; its simulated send time is what its sender's ledger says. Pure bookkeeping:
/// whoever receives keeps the octets, under the slot numbers that are his. Frames that nobody announces are foreign and
/// never become due.
class WireBook {
  public:
    struct Channel {
        std::string link;
        std::uint16_t ethertype{0};
    };
    struct Record {
        std::int64_t send_time_ns{0};
        std::uint64_t identity{0};
    };
    /// A frame that is announced and here.
    struct Match {
        std::size_t slot;
        std::int64_t send_time_ns;
    };

    WireBook(std::size_t processes, std::vector<Channel> channels);

    static constexpr std::size_t kUnknown = static_cast<std::size_t>(-1);
    [[nodiscard]] std::size_t channel_index(std::string_view link, std::uint16_t ethertype) const;

    /// A line of a sender's ledger. `on_match` is called for each frame that has already arrived.
    template <class OnMatch>
    void announced(std::size_t process, std::uint32_t incarnation, std::size_t channel, std::span<Record const> records,
                   OnMatch&& on_match) {
        enter_incarnation(process, incarnation);
        for (Record const& record : records) {
            if (std::size_t const slot = take_early(channel, record.identity); slot != kUnknown) {
                on_match(Match{slot, record.send_time_ns});
            } else {
                awaited_.push_back({process, channel, record});
            }
        }
    }

    struct Arrival {
        bool matched{false};
        std::int64_t send_time_ns{0};
        std::size_t evicted{kUnknown}; ///< the slot of a foreign frame that had to make room
    };
    /// A frame is in `slot`. When nobody has announced it yet, the slot stays taken until somebody does.
    [[nodiscard]] Arrival arrived(std::size_t channel, std::uint64_t identity, std::size_t slot);

    /// Every frame that `process` has announced is here.
    [[nodiscard]] bool complete(std::size_t process) const;
    /// "2 frames of ethertype 0x88ba on 'process_bus'"; empty when complete.
    [[nodiscard]] std::string missing(std::size_t process) const;
    [[nodiscard]] std::size_t unannounced() const { return early_.size(); }

  private:
    static constexpr std::size_t kMaxUnannounced = 1024;
    struct Awaited {
        std::size_t process, channel;
        Record record;
    };
    struct Early {
        std::size_t channel;
        std::uint64_t identity;
        std::size_t slot;
    };
    void enter_incarnation(std::size_t process, std::uint32_t incarnation);
    std::size_t take_early(std::size_t channel, std::uint64_t identity);

    std::vector<Channel> channels_;
    std::vector<std::uint32_t> incarnations_; ///< by process
    std::vector<Awaited> awaited_;            ///< announced, not here
    std::vector<Early> early_;                ///< here, not announced; oldest first
};

} // namespace gridspace::lockstep
