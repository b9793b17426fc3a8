// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/corked_transport.hpp"

#include "bus/gathered_message.hpp"
#include "bus/heartbeat_brake.hpp"
#include "bus/send_together.hpp"
#include "bus/udp_inputs.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>
#include <fastdds/rtps/common/LocatorsIterator.hpp>
#include <fastdds/rtps/network/SenderResource.h>
#include <fastdds/rtps/transport/TransportReceiverInterface.h>
#include <fastrtps/utils/IPLocator.h>
#include <functional>
#include <map>
#include <mutex>
#include <unordered_set>
#include <utility>
#include <vector>

namespace gridspace::bus {
namespace {

namespace fdds = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMaxMessage = 1472;      // one Ethernet frame: no IP fragments
constexpr std::size_t kMaxLocalMessage = 8192; // loopback takes 64 KiB in one piece; not every DDS reads as much

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wnon-virtual-dtor" // the base class is the library's, and nobody deletes through it
class LocatorWalk final : public fdds::LocatorsIterator {
  public:
    explicit LocatorWalk(rtps::Locator_t const* at) : at_{at} {}
    LocatorsIterator& operator++() override {
        ++at_;
        return *this;
    }
    bool operator==(LocatorsIterator const& other) const override {
        return at_ == static_cast<LocatorWalk const&>(other).at_;
    }
    bool operator!=(LocatorsIterator const& other) const override { return !(*this == other); }
    rtps::Locator_t const& operator*() const override { return *at_; }

  private:
    rtps::Locator_t const* at_;
};
#pragma GCC diagnostic pop

using Destination = std::uint64_t; ///< IPv4 address and port
Destination destination_of(rtps::Locator_t const& locator) {
    std::uint32_t ipv4 = 0;
    std::memcpy(&ipv4, rtps::IPLocator::getIPv4(locator), sizeof ipv4);
    return std::uint64_t{ipv4} << 16U | rtps::IPLocator::getPhysicalPort(locator);
}

using OwnAddresses = std::vector<std::uint32_t>;
OwnAddresses numbers_of(std::vector<std::string> const& addresses) {
    OwnAddresses out;
    for (std::string const& address : addresses) {
        rtps::Locator_t locator;
        rtps::IPLocator::setIPv4(locator, address);
        out.push_back(static_cast<std::uint32_t>(destination_of(locator) >> 16U));
    }
    return out;
}
std::size_t longest_to(Destination destination, OwnAddresses const& own) {
    bool const local = std::ranges::find(own, static_cast<std::uint32_t>(destination >> 16U)) != own.end();
    return local ? kMaxLocalMessage : kMaxMessage;
}

struct Held {
    rtps::SenderResource* resource{nullptr};
    std::vector<rtps::Locator_t> locators;
    OwnAddresses const* own{nullptr}; ///< of the participant
    std::size_t longest{0};           ///< octets that all of `locators` take
    GatheredMessage message;
};

/// The gathered messages of one thread. Buffers are kept for the next tick.
struct Gathering {
    bool corked{false};
    std::vector<Held> held;
    std::size_t used{0};
    std::vector<rtps::Locator_t> locators; // of the message at hand
    std::map<std::pair<rtps::SenderResource*, Destination>, Held> by_destination;
    bool is_spread{false}; ///< there is something in it
};

thread_local Gathering t_gathering;

bool send_now(rtps::SenderResource* resource, std::span<std::uint8_t const> message,
              std::vector<rtps::Locator_t> const& locators, Clock::time_point const& timeout) {
    LocatorWalk begin{locators.data()};
    LocatorWalk end{locators.data() + locators.size()};
    return resource->send(message.data(), static_cast<std::uint32_t>(message.size()), &begin, &end, timeout);
}

void send_held(Held& held, Clock::time_point const& timeout) {
    send_now(held.resource, held.message.finish(), held.locators, timeout);
    held.message.clear();
}

/// Topics have different readers, so several messages may be for one destination: again one for each, in their order.
void add_for_destinations(Held const& held, Clock::time_point const& timeout) {
    MessageParts const parts = held.message.parts();
    for (rtps::Locator_t const& locator : held.locators) {
        Destination const destination = destination_of(locator);
        Held& to = t_gathering.by_destination[{held.resource, destination}];
        if (to.locators.empty()) {
            to = {held.resource, {locator}, nullptr, longest_to(destination, *held.own), {}};
        }
        if (!to.message.empty() && !to.message.takes(parts, to.longest)) {
            send_held(to, timeout);
        }
        to.message.add(parts);
    }
}

Clock::time_point soon() {
    return Clock::now() + std::chrono::milliseconds{100};
}

/// What is held goes to its destinations' messages, of which those leave that are full. If all of it has the same
/// destinations, as in most ticks, it leaves as it is.
void spread() {
    Gathering& g = t_gathering;
    std::span const all = std::span{g.held}.first(std::exchange(g.used, 0));
    if (all.empty()) {
        return;
    }
    auto const timeout = soon();
    if (all.size() == 1 && !g.is_spread) {
        send_held(all.front(), timeout);
        return;
    }
    for (Held& held : all) {
        add_for_destinations(held, timeout);
        held.message.clear();
    }
    g.is_spread = true;
}

void flush() {
    Gathering& g = t_gathering;
    spread();
    if (!std::exchange(g.is_spread, false)) {
        return;
    }
    auto const timeout = soon();
    for (auto& [destination, to] : g.by_destination) {
        if (!to.message.empty()) {
            send_held(to, timeout);
        }
    }
}

class CorkedTransport final : public fdds::ChainingTransport {
  public:
    explicit CorkedTransport(CorkedTransportDescriptor const& descriptor)
        : ChainingTransport{descriptor}, descriptor_{descriptor}, own_addresses_{numbers_of(descriptor.interfaces)} {}

    fdds::TransportDescriptorInterface* get_configuration() override { return &descriptor_; }

    bool send(rtps::SenderResource* resource, rtps::octet const* bytes, std::uint32_t size,
              fdds::LocatorsIterator* begin, fdds::LocatorsIterator* end, Clock::time_point const& timeout) override {
        Gathering& g = t_gathering;
        g.locators.clear();
        for (; *begin != *end; ++*begin) {
            g.locators.push_back(**begin);
            make_known(**begin);
        }
        if (HeartbeatBrake::concerns({bytes, size}) &&
            !brake_.lets_pass({bytes, size}, g.locators.size(), Clock::now())) {
            return true;
        }
        std::span const message{bytes, size};
        if (!g.corked) {
            return send_now(resource, message, g.locators, timeout);
        }
        MessageParts const parts = parts_of(message);
        if (!parts.mergeable) {
            flush(); // nothing overtakes
            return send_now(resource, message, g.locators, timeout);
        }
        for (std::size_t i = g.used; i-- > 0;) {
            Held& held = g.held[i];
            if (held.resource != resource || held.locators != g.locators) {
                continue;
            }
            if (held.message.takes(parts, held.longest)) {
                held.message.add(parts);
                return true;
            }
            spread();
            break;
        }
        if (g.used == g.held.size()) {
            g.held.emplace_back();
        }
        Held& held = g.held[g.used++];
        held.resource = resource;
        held.locators = g.locators;
        held.own = &own_addresses_;
        held.longest = longest_to_all(g.locators);
        held.message.add(parts);
        return true;
    }

    void receive(fdds::TransportReceiverInterface* next, rtps::octet const* bytes, std::uint32_t size,
                 rtps::Locator_t const& local, rtps::Locator_t const& remote) override {
        // The octets are the socket's own buffer, of its only thread, and may be changed (ChainingTransport::receive).
        admit(*next, {const_cast<rtps::octet*>(bytes), size}, local, remote);
    }

    bool IsInputChannelOpen(rtps::Locator_t const& locator) const override {
        std::lock_guard const lock{inputs_mutex_};
        return descriptor_.interfaces.empty() ? ChainingTransport::IsInputChannelOpen(locator)
                                              : inputs_.contains(key_of(locator));
    }

    bool OpenInputChannel(rtps::Locator_t const& locator, fdds::TransportReceiverInterface* receiver,
                          std::uint32_t max_message_size) override {
        if (descriptor_.interfaces.empty()) {
            return ChainingTransport::OpenInputChannel(locator, receiver, max_message_size);
        }
        if (!is_locator_allowed(locator)) {
            return false;
        }
        std::lock_guard const lock{inputs_mutex_};
        if (inputs_.contains(key_of(locator))) {
            return true;
        }
        UdpInput::Options options;
        options.interfaces = descriptor_.interfaces;
        options.port = rtps::IPLocator::getPhysicalPort(locator);
        options.group = rtps::IPLocator::isMulticast(locator) ? rtps::IPLocator::toIPv4string(locator) : "";
        options.receive_buffer = descriptor_.receive_buffer;
        options.longest = max_message_size;
        auto input = UdpInput::open(options, [this, receiver, locator](std::span<std::uint8_t> datagram,
                                                                       std::uint32_t from, std::uint16_t port) {
            rtps::Locator_t remote;
            rtps::IPLocator::setIPv4(remote, static_cast<std::uint8_t>(from >> 24U),
                                     static_cast<std::uint8_t>(from >> 16U), static_cast<std::uint8_t>(from >> 8U),
                                     static_cast<std::uint8_t>(from));
            rtps::IPLocator::setPhysicalPort(remote, port);
            admit(*receiver, datagram, locator, remote);
        });
        if (input == nullptr) {
            return false;
        }
        inputs_.emplace(key_of(locator), std::move(input));
        if (options.group.empty() && options.port % 2 == 1 && descriptor_.samples_port) {
            *descriptor_.samples_port = options.port;
        }
        return true;
    }

    bool CloseInputChannel(rtps::Locator_t const& locator) override {
        if (descriptor_.interfaces.empty()) {
            return ChainingTransport::CloseInputChannel(locator);
        }
        decltype(inputs_)::node_type closed; // goes outside of the lock: somebody may be inside its receiver
        std::lock_guard const lock{inputs_mutex_};
        closed = inputs_.extract(key_of(locator));
        return !closed.empty();
    }

  private:
    /// The library's own ports are by number alone, and of a group's.
    using Key = std::pair<std::uint16_t, std::string>;
    static Key key_of(rtps::Locator_t const& locator) {
        return {rtps::IPLocator::getPhysicalPort(locator),
                rtps::IPLocator::isMulticast(locator) ? rtps::IPLocator::toIPv4string(locator) : ""};
    }

    [[nodiscard]] std::size_t longest_to_all(std::vector<rtps::Locator_t> const& locators) const {
        std::size_t out = kMaxLocalMessage;
        for (rtps::Locator_t const& locator : locators) {
            out = std::min(out, longest_to(destination_of(locator), own_addresses_));
        }
        return out;
    }

    /// 2.9.1 counts what it sends, by locator, and asserts that it knows each. It does not know the own address of a
    /// reader in a multicast group, to which all goes that is for this reader alone. An assertion of the library would
    /// end the process.
    void make_known(rtps::Locator_t const& locator) {
        if (outputs_.insert(destination_of(locator)).second) {
            fdds::SendResourceList none; // the sockets are there
            low_level_transport_->OpenOutputChannel(none, locator);
        }
    }

    void admit(fdds::TransportReceiverInterface& next, std::span<std::uint8_t> datagram, rtps::Locator_t const& local,
               rtps::Locator_t const& remote) {
        std::int64_t const now_ns = std::chrono::nanoseconds{Clock::now().time_since_epoch()}.count();
        auto const give = [&](std::span<std::uint8_t const> message) {
            next.OnDataReceived(message.data(), static_cast<std::uint32_t>(message.size()), local, remote);
        };
        descriptor_.gate->admit(datagram, now_ns, std::ref(give)); // by reference: no memory is asked for
    }

    CorkedTransportDescriptor descriptor_;
    OwnAddresses const own_addresses_; ///< as destination_of() gives them
    mutable std::mutex inputs_mutex_;
    std::map<Key, std::unique_ptr<UdpInput>> inputs_;
    // Of send(), for which the participant holds the mutex of its senders.
    std::unordered_set<Destination> outputs_;
    HeartbeatBrake brake_;
};

} // namespace

fdds::TransportInterface* CorkedTransportDescriptor::create_transport() const {
    return new CorkedTransport{*this};
}

SendTogether::SendTogether() {
    assert(!t_gathering.corked);
    t_gathering.corked = true;
}

SendTogether::~SendTogether() {
    t_gathering.corked = false;
    flush();
}

} // namespace gridspace::bus
