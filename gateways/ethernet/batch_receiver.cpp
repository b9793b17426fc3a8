// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Receiving by recvmmsg(2), where there is no ring (emulators), or recvmsg(2), where there is not even that.
#include "gateways/ethernet/packet_socket.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <sys/socket.h>

namespace gridspace::ethernet {
namespace {

constexpr std::size_t kBatch = 64, kRoom = 8, kLongest = 2048;

class BatchReceiver final : public Receiver {
  public:
    explicit BatchReceiver(int fd) : fd_{fd}, slots_(kBatch), messages_(kBatch) {
        for (std::size_t i = 0; i < kBatch; ++i) {
            slots_[i].part = {slots_[i].octets.data() + kRoom, kLongest};
        }
    }

    [[nodiscard]] bool is_ring() const noexcept override { return false; }

    [[nodiscard]] std::size_t receive(std::span<ReceivedFrame> out) noexcept override {
        std::size_t const wanted = std::min(out.size(), kBatch);
        for (std::size_t i = 0; i < wanted; ++i) {
            Slot& slot = slots_[i];
            msghdr& message = messages_[i].msg_hdr;
            message = {};
            message.msg_name = &slot.from;
            message.msg_namelen = sizeof slot.from;
            message.msg_iov = &slot.part;
            message.msg_iovlen = 1;
            message.msg_control = slot.control.data();
            message.msg_controllen = slot.control.size();
        }
        int count = ::recvmmsg(fd_, messages_.data(), static_cast<unsigned>(wanted), MSG_DONTWAIT, nullptr);
        if (count < 0 && errno == ENOSYS && wanted > 0) {
            ssize_t const size = ::recvmsg(fd_, &messages_[0].msg_hdr, MSG_DONTWAIT);
            messages_[0].msg_len = size < 0 ? 0 : static_cast<unsigned>(size);
            count = size < 0 ? 0 : 1;
        }
        for (int i = 0; i < count; ++i) {
            out[static_cast<std::size_t>(i)] = frame_of(static_cast<std::size_t>(i));
        }
        return count < 0 ? 0 : static_cast<std::size_t>(count);
    }

  private:
    struct Slot {
        sockaddr_ll from{};
        iovec part{};
        alignas(cmsghdr) std::array<std::uint8_t, 256> control{};
        std::array<std::uint8_t, kRoom + kLongest> octets{};
    };

    [[nodiscard]] ReceivedFrame frame_of(std::size_t i) noexcept {
        Slot& slot = slots_[i];
        msghdr& message = messages_[i].msg_hdr;
        std::uint8_t* octets = slot.octets.data() + kRoom;
        std::size_t size = messages_[i].msg_len;
        ReceivedFrame out;
        out.outgoing = slot.from.sll_pkttype == PACKET_OUTGOING;
        out.truncated = (message.msg_flags & MSG_TRUNC) != 0;
        for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
            if (c->cmsg_level == SOL_PACKET && c->cmsg_type == PACKET_AUXDATA &&
                c->cmsg_len >= CMSG_LEN(sizeof(tpacket_auxdata))) {
                tpacket_auxdata aux{};
                std::memcpy(&aux, CMSG_DATA(c), sizeof aux);
                if ((aux.tp_status & TP_STATUS_VLAN_VALID) != 0 && size >= 12) {
                    octets = restore_tag(octets,
                                         (aux.tp_status & TP_STATUS_VLAN_TPID_VALID) != 0 ? aux.tp_vlan_tpid
                                                                                          : std::uint16_t{ETH_P_8021Q},
                                         aux.tp_vlan_tci);
                    size += 4;
                }
            } else if (c->cmsg_level == SOL_SOCKET && c->cmsg_type == SO_TIMESTAMPNS) {
                timespec stamp{};
                std::memcpy(&stamp, CMSG_DATA(c), sizeof stamp);
                out.stamp_ns = std::int64_t{stamp.tv_sec} * 1'000'000'000 + stamp.tv_nsec;
            }
        }
        out.octets = Octets{octets, size};
        return out;
    }

    int fd_;
    std::vector<Slot> slots_;
    std::vector<mmsghdr> messages_;
};

} // namespace

std::unique_ptr<Receiver> make_batch_receiver(int fd) {
    return std::make_unique<BatchReceiver>(fd);
}

} // namespace gridspace::ethernet
