// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/corked_transport.hpp"

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
#include <vector>

namespace gridspace::bus {
namespace {

namespace fdds = eprosima::fastdds::rtps;
namespace rtps = eprosima::fastrtps::rtps;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kHeaderSize = 20;   // "RTPS", version, vendor, GUID prefix
constexpr std::size_t kMaxMessage = 1472; // one Ethernet frame: no IP fragments
constexpr std::size_t kGuidPrefixSize = 12;
// A vendor's submessage that ends every datagram of Fast DDS. Its UDP transport fills it in by position: it looks for
// this octet at a fixed distance from the end, so a message without it may have its payload overwritten. A merged
// message therefore ends in exactly one.
constexpr std::uint8_t kStatistics = 0x80;

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

/// What decides whether two messages may become one.
struct Shape {
    bool mergeable{false};
    std::size_t body{0};  ///< octets up to the statistics submessage at the end
    bool directed{false}; ///< has an INFO_DST; all of them name `destination`
    std::array<std::uint8_t, kGuidPrefixSize> destination{};
};

/// Walks the submessages. Only kinds whose meaning does not depend on being alone in a message are merged.
Shape shape_of(std::uint8_t const* message, std::size_t size) {
    constexpr std::array<std::uint8_t, 9> kPlain{
        0x06 /*ACKNACK*/,  0x07 /*HEARTBEAT*/,  0x08 /*GAP*/, 0x09 /*INFO_TS*/, 0x0e /*INFO_DST*/, 0x15 /*DATA*/,
        0x30 /*SEC_BODY*/, 0x31 /*SEC_PREFIX*/, 0x32 /*SEC_POSTFIX*/}; // these three stay together
    Shape shape;
    std::size_t at = kHeaderSize;
    while (at + 4 <= size) {
        std::uint8_t const id = message[at];
        bool const little = (message[at + 1] & 1U) != 0;
        std::size_t const length =
            little ? message[at + 2] | (message[at + 3] << 8U) : message[at + 3] | (message[at + 2] << 8U);
        if (id == kStatistics && at + 4 + length == size) {
            break;
        }
        bool const has_no_body = id == 0x09 && (message[at + 1] & 2U) != 0; // INFO_TS that invalidates
        if (std::find(kPlain.begin(), kPlain.end(), id) == kPlain.end() || (length == 0 && !has_no_body) ||
            at + 4 + length > size) {
            return shape;
        }
        if (id == 0x0e) {
            if (length != kGuidPrefixSize ||
                (shape.directed && std::memcmp(shape.destination.data(), message + at + 4, kGuidPrefixSize) != 0)) {
                return shape;
            }
            std::memcpy(shape.destination.data(), message + at + 4, kGuidPrefixSize);
            shape.directed = true;
        }
        at += 4 + length;
    }
    shape.body = at;
    shape.mergeable = true;
    return shape;
}

struct CorkedMessage {
    rtps::SenderResource* resource{nullptr};
    std::vector<rtps::Locator_t> locators;
    std::vector<std::uint8_t> bytes; ///< without `tail`
    std::vector<std::uint8_t> tail;  ///< the statistics submessage, or empty
    Shape shape;
};

/// The gathered messages of one thread. Buffers are kept for the next tick.
struct Gathering {
    bool corked{false};
    std::vector<CorkedMessage> held;
    std::size_t used{0};
    std::vector<rtps::Locator_t> locators; // of the message at hand
};

thread_local Gathering t_gathering;

bool send_now(rtps::SenderResource* resource, std::uint8_t const* bytes, std::size_t size,
              std::vector<rtps::Locator_t> const& locators, Clock::time_point const& timeout) {
    LocatorWalk begin{locators.data()};
    LocatorWalk end{locators.data() + locators.size()};
    return resource->send(bytes, static_cast<std::uint32_t>(size), &begin, &end, timeout);
}

void flush() {
    Gathering& g = t_gathering;
    auto const timeout = Clock::now() + std::chrono::milliseconds{100};
    for (std::size_t i = 0; i < g.used; ++i) {
        CorkedMessage& held = g.held[i];
        held.bytes.insert(held.bytes.end(), held.tail.begin(), held.tail.end());
        send_now(held.resource, held.bytes.data(), held.bytes.size(), held.locators, timeout);
    }
    g.used = 0;
}

class CorkedTransport final : public fdds::ChainingTransport {
  public:
    explicit CorkedTransport(CorkedTransportDescriptor const& descriptor)
        : ChainingTransport{descriptor}, descriptor_{descriptor} {}

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
        if (!g.corked) {
            return send_now(resource, bytes, size, g.locators, timeout);
        }
        Shape const shape = shape_of(bytes, size);
        if (!shape.mergeable) {
            flush(); // nothing overtakes
            return send_now(resource, bytes, size, g.locators, timeout);
        }
        for (std::size_t i = g.used; i-- > 0;) {
            CorkedMessage& held = g.held[i];
            if (held.resource != resource || held.locators != g.locators) {
                continue;
            }
            bool const same_destination = // an INFO_DST stays in force until the next one
                held.shape.directed == shape.directed && held.shape.destination == shape.destination;
            if (same_destination && held.bytes.size() + size - kHeaderSize <= kMaxMessage &&
                std::memcmp(held.bytes.data(), bytes, kHeaderSize) == 0) {
                held.bytes.insert(held.bytes.end(), bytes + kHeaderSize, bytes + shape.body);
                held.tail.assign(bytes + shape.body, bytes + size);
                return true;
            }
            flush();
            break;
        }
        if (g.used == g.held.size()) {
            g.held.emplace_back();
            g.held.back().bytes.reserve(kMaxMessage);
        }
        CorkedMessage& held = g.held[g.used++];
        held.resource = resource;
        held.locators = g.locators;
        held.bytes.assign(bytes, bytes + shape.body);
        held.tail.assign(bytes + shape.body, bytes + size);
        held.shape = shape;
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

    /// 2.9.1 counts what it sends, by locator, and asserts that it knows each. It does not know the own address of a
    /// reader in a multicast group, to which all goes that is for this reader alone. An assertion of the library would
    /// end the process.
    void make_known(rtps::Locator_t const& locator) {
        std::uint32_t ipv4 = 0;
        std::memcpy(&ipv4, rtps::IPLocator::getIPv4(locator), sizeof ipv4);
        if (outputs_.insert(std::uint64_t{ipv4} << 16U | rtps::IPLocator::getPhysicalPort(locator)).second) {
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
    mutable std::mutex inputs_mutex_;
    std::map<Key, std::unique_ptr<UdpInput>> inputs_;
    // Of send(), for which the participant holds the mutex of its senders.
    std::unordered_set<std::uint64_t> outputs_; ///< IPv4 addresses and ports
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
