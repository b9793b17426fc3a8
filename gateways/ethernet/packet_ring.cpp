// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Receiving through memory shared with the kernel. TPACKET_V2, not V3: a slot is ours as soon as its frame is there,
// while V3 hands out whole blocks, a millisecond late or more.
#include "gateways/ethernet/packet_socket.hpp"

#include <atomic>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <sys/mman.h>
#include <sys/socket.h>

namespace gridspace::ethernet {
namespace {

constexpr std::size_t kSlot = 2048, kBlock = 1U << 16U;

class Ring final : public Receiver {
  public:
    Ring(void* memory, std::size_t slots) noexcept : memory_{static_cast<std::uint8_t*>(memory)}, slots_{slots} {}
    Ring(Ring const&) = delete;
    Ring& operator=(Ring const&) = delete;
    ~Ring() override { ::munmap(memory_, slots_ * kSlot); }

    [[nodiscard]] bool is_ring() const noexcept override { return true; }

    [[nodiscard]] std::size_t receive(std::span<ReceivedFrame> out) noexcept override {
        for (; held_ != 0; --held_) { // what the last call gave out goes back
            std::atomic_ref{header(released_)->tp_status}.store(TP_STATUS_KERNEL, std::memory_order_release);
            released_ = released_ + 1 == slots_ ? 0 : released_ + 1;
        }
        std::size_t count = 0;
        for (; count < out.size() && count < slots_; ++count) {
            tpacket2_hdr* const slot = header(next_);
            std::uint32_t const status = std::atomic_ref{slot->tp_status}.load(std::memory_order_acquire);
            if ((status & TP_STATUS_USER) == 0) {
                break;
            }
            out[count] = frame_of(*slot, status);
            next_ = next_ + 1 == slots_ ? 0 : next_ + 1;
        }
        held_ = count;
        return count;
    }

  private:
    [[nodiscard]] tpacket2_hdr* header(std::size_t slot) const noexcept {
        return reinterpret_cast<tpacket2_hdr*>(memory_ + slot * kSlot);
    }

    [[nodiscard]] static ReceivedFrame frame_of(tpacket2_hdr& slot, std::uint32_t status) noexcept {
        auto* const base = reinterpret_cast<std::uint8_t*>(&slot);
        auto const* const from = reinterpret_cast<sockaddr_ll const*>(base + TPACKET_ALIGN(sizeof(tpacket2_hdr)));
        std::uint8_t* octets = base + slot.tp_mac;
        std::size_t size = slot.tp_snaplen;
        if ((status & TP_STATUS_VLAN_VALID) != 0 && size >= 12) {
            octets = restore_tag(
                octets, (status & TP_STATUS_VLAN_TPID_VALID) != 0 ? slot.tp_vlan_tpid : std::uint16_t{ETH_P_8021Q},
                slot.tp_vlan_tci);
            size += 4;
        }
        return {Octets{octets, size}, std::int64_t{slot.tp_sec} * 1'000'000'000 + slot.tp_nsec,
                from->sll_pkttype == PACKET_OUTGOING, slot.tp_snaplen < slot.tp_len};
    }

    std::uint8_t* memory_;
    std::size_t slots_;
    std::size_t next_{0}, released_{0}, held_{0};
};

} // namespace

std::unique_ptr<Receiver> make_ring(int fd, std::size_t frames) {
    int const version = TPACKET_V2;
    unsigned const reserve = 8; // for a VLAN tag in front of the frame
    if (::setsockopt(fd, SOL_PACKET, PACKET_VERSION, &version, sizeof version) != 0 ||
        ::setsockopt(fd, SOL_PACKET, PACKET_RESERVE, &reserve, sizeof reserve) != 0) {
        return nullptr;
    }
    std::size_t const blocks = std::max<std::size_t>(1, frames * kSlot / kBlock);
    tpacket_req request{};
    request.tp_block_size = kBlock;
    request.tp_block_nr = static_cast<unsigned>(blocks);
    request.tp_frame_size = kSlot;
    request.tp_frame_nr = static_cast<unsigned>(blocks * kBlock / kSlot);
    if (::setsockopt(fd, SOL_PACKET, PACKET_RX_RING, &request, sizeof request) != 0) {
        return nullptr;
    }
    void* const memory = ::mmap(nullptr, blocks * kBlock, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    if (memory == MAP_FAILED) {
        tpacket_req const none{};
        ::setsockopt(fd, SOL_PACKET, PACKET_RX_RING, &none, sizeof none);
        return nullptr;
    }
    return std::make_unique<Ring>(memory, request.tp_frame_nr);
}

} // namespace gridspace::ethernet
