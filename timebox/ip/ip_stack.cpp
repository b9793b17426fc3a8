// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/ip/ip_stack.hpp"

#include "common/random.hpp"

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <utility>

extern "C" { // its functions are of C, and it does not say so
#include <lwipopts.h>
}

#include <lwip/igmp.h>
#include <lwip/init.h>
#include <lwip/ip.h>
#include <lwip/netif.h>
#include <lwip/pbuf.h>
#include <lwip/priv/tcp_priv.h>
#include <lwip/tcpip.h>
#include <lwip/timeouts.h>

namespace gridspace::timebox {
namespace {

constexpr std::size_t kHeader = 14;
constexpr std::uint16_t kMtu = 1500;
constexpr std::int64_t kNsPerMs = 1'000'000;

/// What lwIP asks of its surroundings. It has been built for threads; here it has none.
struct Surroundings {
    std::uint32_t now_ms{0};
    Random* random{nullptr}; ///< while the stack is at work
    std::deque<std::pair<tcpip_callback_fn, void*>> later;
};
thread_local Surroundings surroundings;

bool has_begun = false; ///< lwIP cannot be begun twice

} // namespace
} // namespace gridspace::timebox

// These take the place of the functions of the same name in the library: the dynamic linker finds those of the program
// first.
extern "C" {

u32_t sys_now() {
    return gridspace::timebox::surroundings.now_ms;
}

void sys_check_core_locking() {} // one thread

err_t tcpip_try_callback(tcpip_callback_fn function, void* context) {
    gridspace::timebox::surroundings.later.emplace_back(function, context);
    return ERR_OK;
}

int rand() { // NOLINT: others in this process keep what they had, a sequence that nobody promises
    auto* const random = gridspace::timebox::surroundings.random;
    return random == nullptr ? static_cast<int>(::random()) : static_cast<int>(random->next() & RAND_MAX);
}
}

namespace gridspace::timebox {

struct IpStack::Impl {
    Impl(IpLink l, std::uint64_t seed, Send s) : link{std::move(l)}, random{seed, "ip"}, send{std::move(s)} {}

    err_t output(pbuf* packet, std::uint32_t to);
    [[nodiscard]] std::optional<MacOctets> mac_of(std::uint32_t to) const;

    IpLink link;
    Random random;
    Send send;
    netif ethernet{}, loopback{};
    std::vector<std::uint8_t> frame;
    std::vector<std::string> refused;
    std::int64_t now_ns{0};
};

namespace {

/// Random numbers are the box's while this lives.
class AtWork {
  public:
    explicit AtWork(Random& random) : before_{surroundings.random} { surroundings.random = &random; }
    ~AtWork() { surroundings.random = before_; }
    AtWork(AtWork const&) = delete;
    AtWork& operator=(AtWork const&) = delete;

  private:
    Random* before_;
};

std::uint32_t mask_of(int prefix) {
    return prefix <= 0 ? 0 : ~std::uint32_t{0} << static_cast<unsigned>(32 - prefix);
}

bool is_multicast(std::uint32_t address) {
    return (address >> 28U) == 0xE;
}

ip4_addr_t of(std::uint32_t address) {
    return {lwip_htonl(address)};
}

} // namespace

bool IpStack::is_broadcast(std::uint32_t address) const {
    return address == ~std::uint32_t{0} || address == (impl_->link.address | ~mask_of(impl_->link.prefix));
}

std::optional<MacOctets> IpStack::Impl::mac_of(std::uint32_t to) const {
    if (to == ~std::uint32_t{0} || to == (link.address | ~mask_of(link.prefix))) {
        return MacOctets{0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF};
    }
    if (is_multicast(to)) { // RFC 1112, 6.4
        return MacOctets{0x01,
                         0x00,
                         0x5E,
                         static_cast<std::uint8_t>((to >> 16U) & 0x7FU),
                         static_cast<std::uint8_t>(to >> 8U),
                         static_cast<std::uint8_t>(to)};
    }
    auto const found = link.neighbours.find(to);
    return found == link.neighbours.end() ? std::nullopt : std::optional{found->second};
}

err_t IpStack::Impl::output(pbuf* packet, std::uint32_t to) {
    auto const mac = mac_of(to);
    if (!mac) {
        return ERR_RTE;
    }
    frame.assign(kHeader + packet->tot_len, 0); // not padded: a switch may take that off
    std::copy(mac->begin(), mac->end(), frame.begin());
    std::copy(link.mac.begin(), link.mac.end(), frame.begin() + 6);
    frame[12] = 0x08;
    pbuf_copy_partial(packet, frame.data() + kHeader, packet->tot_len, 0);
    if (std::string why = send(frame); !why.empty()) {
        refused.push_back(std::move(why));
        return ERR_IF;
    }
    return ERR_OK;
}

IpStack::IpStack(IpLink const& link, std::uint64_t seed, Send send)
    : impl_{std::make_unique<Impl>(link, seed, std::move(send))} {
    AtWork const at_work{impl_->random};
    if (!std::exchange(has_begun, true)) {
        lwip_init();
    }
    ip4_addr_t const own = of(link.address), mask = of(mask_of(link.prefix)), none = of(0);
    netif_add(
        &impl_->ethernet, &own, &mask, &none, impl_.get(),
        [](netif* n) -> err_t {
            n->name[0] = 'e';
            n->name[1] = 'n';
            n->mtu = kMtu;
            n->flags = NETIF_FLAG_BROADCAST | NETIF_FLAG_LINK_UP | NETIF_FLAG_IGMP;
            n->output = [](netif* via, pbuf* packet, ip4_addr_t const* to) -> err_t {
                return static_cast<Impl*>(via->state)->output(packet, lwip_ntohl(to->addr));
            };
            return ERR_OK;
        },
        ip_input);
    ip4_addr_t const local = of(0x7F000001), local_mask = of(0xFF000000);
    netif_add(
        &impl_->loopback, &local, &local_mask, &none, impl_.get(),
        [](netif* n) -> err_t {
            n->name[0] = 'l';
            n->name[1] = 'o';
            n->mtu = kMtu;
            n->flags = NETIF_FLAG_LINK_UP;
            n->output = [](netif* via, pbuf* packet, ip4_addr_t const*) -> err_t {
                return netif_loop_output(via, packet);
            };
            return ERR_OK;
        },
        ip_input);
    netif_set_up(&impl_->loopback);
    netif_set_up(&impl_->ethernet);
    netif_set_default(&impl_->ethernet);
    settle();
}

IpStack::~IpStack() {
    settle(); // what is on its way to itself is memory
    impl_->send = [](std::span<std::uint8_t const>) { return std::string{}; };
    netif_remove(&impl_->ethernet);
    netif_remove(&impl_->loopback);
    surroundings.later.clear();
}

IpLink const& IpStack::link() const {
    return impl_->link;
}

bool IpStack::reaches(std::uint32_t address) const {
    return (address >> 24U) == 127 || address == impl_->link.address || impl_->mac_of(address).has_value();
}

void IpStack::settle() {
    AtWork const at_work{impl_->random};
    while (!surroundings.later.empty()) {
        auto const [function, context] = surroundings.later.front();
        surroundings.later.pop_front();
        function(context);
    }
}

void IpStack::elapse_to(std::int64_t now_ns) {
    AtWork const at_work{impl_->random};
    impl_->now_ns = std::max(impl_->now_ns, now_ns);
    surroundings.now_ms = static_cast<std::uint32_t>(impl_->now_ns / kNsPerMs);
    sys_check_timeouts();
    settle();
}

void IpStack::acknowledge() {
    AtWork const at_work{impl_->random};
    for (tcp_pcb* pcb = tcp_active_pcbs; pcb != nullptr;) {
        tcp_pcb* const next = pcb->next;
        if ((pcb->flags & TF_ACK_DELAY) != 0) {
            pcb->flags |= TF_ACK_NOW;
            tcp_output(pcb);
        }
        pcb = next;
    }
    settle();
}

std::int64_t IpStack::next_ns() const {
    std::uint32_t const sleep_ms = sys_timeouts_sleeptime();
    return (impl_->now_ns / kNsPerMs + static_cast<std::int64_t>(sleep_ms)) * kNsPerMs;
}

void IpStack::receive(std::span<std::uint8_t const> frame) {
    bool const multicast = !frame.empty() && (frame[0] & 1U) != 0;
    if (frame.size() <= kHeader || frame[12] != 0x08 || frame[13] != 0 ||
        (!multicast && !std::equal(impl_->link.mac.begin(), impl_->link.mac.end(), frame.begin()))) {
        return;
    }
    std::span<std::uint8_t const> const packet = frame.subspan(kHeader);
    pbuf* const buffer = pbuf_alloc(PBUF_RAW, static_cast<u16_t>(packet.size()), PBUF_RAM);
    if (buffer == nullptr) {
        return;
    }
    buffer->flags = static_cast<u8_t>(buffer->flags | (multicast ? PBUF_FLAG_LLMCAST : 0));
    pbuf_take(buffer, packet.data(), static_cast<u16_t>(packet.size()));
    AtWork const at_work{impl_->random};
    if (ip_input(buffer, &impl_->ethernet) != ERR_OK) {
        pbuf_free(buffer);
    }
    settle();
}

void IpStack::join(std::uint32_t group) {
    AtWork const at_work{impl_->random};
    ip4_addr_t const address = of(group);
    (void)igmp_joingroup_netif(&impl_->ethernet, &address);
    settle();
}

void IpStack::leave(std::uint32_t group) {
    AtWork const at_work{impl_->random};
    ip4_addr_t const address = of(group);
    (void)igmp_leavegroup_netif(&impl_->ethernet, &address);
    settle();
}

std::vector<std::string> IpStack::take_refused() {
    return std::exchange(impl_->refused, {});
}

} // namespace gridspace::timebox
