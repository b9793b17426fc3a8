// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/participant.hpp"

#include "bus/corked_transport.hpp"
#include "bus/endpoints_impl.hpp"
#include "bus/local_addresses.hpp"
#include "bus/participant_listener_impl.hpp"
#include "bus/raw_access_impl.hpp"
#include "bus/thread_ids.hpp"
#include "common/log.hpp"
#include "common/text.hpp"

#include <atomic>
#include <cstdlib>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <fmt/format.h>
#include <map>
#include <mutex>
#include <set>

namespace gridspace::bus {
namespace {

class FastDdsParticipant final : public Participant {
  public:
    FastDdsParticipant(ParticipantOptions options, DiscoveryObserver* observer)
        : options_{std::move(options)}, listener_{directory_, endpoints_, observer} {}

    ~FastDdsParticipant() override {
        if (participant_ == nullptr) {
            return;
        }
        participant_->set_listener(nullptr);
        participant_->delete_contained_entities();
        dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
        if (std::string const refused = refused_datagrams(); !refused.empty()) {
            log::warning("datagrams that were kept from DDS: {}", refused);
        }
    }

    Result<void> open(TcpLink const* link = nullptr) {
        if (auto ok = wait_for_addresses(options_.addresses, options_.address_patience); !ok) {
            return ok;
        }
        std::lock_guard const lock{profiles_mutex()};
        auto* factory = dds::DomainParticipantFactory::get_instance();
        if (auto ok = load_profiles(); !ok) {
            return ok;
        }
        dds::DomainParticipantQos qos;
        if (factory->get_participant_qos_from_profile(options_.profile, qos) != ReturnCode_t::RETCODE_OK) {
            return fail(ExitCode::usage, fmt::format("'{}' has no participant profile named '{}'",
                                                     options_.qos_file.string(), options_.profile));
        }
        qos.name(options_.process.c_str());
        std::string const user_data = user_data_of(options_);
        qos.user_data().setValue(std::vector<rtps::octet>{user_data.begin(), user_data.end()});
        secured_ = rtps::PropertyPolicyHelper::find_property(qos.properties(), "dds.sec.auth.plugin") != nullptr;
        if (secured_) {
            listener_.secure();
        }
        prepare_transports(qos);
        bound_the_others(qos);
        if (auto ok = look_for_peers(qos); !ok) {
            return ok;
        }
        if (link != nullptr) {
            if (auto ok = apply(*link, qos); !ok) {
                return ok;
            }
        }
        participant_ = factory->create_participant(static_cast<std::uint32_t>(options_.domain), qos, &listener_,
                                                   dds::StatusMask::none());
        if (participant_ == nullptr && secured_) {
            return fail(ExitCode::environment,
                        fmt::format("DDS Security lets '{}' not join domain {}", options_.process, options_.domain),
                        "its log says why: a certificate that has expired or is revoked, a key of somebody else, or "
                        "documents of another authority");
        }
        if (participant_ == nullptr) {
            return fail(ExitCode::environment,
                        fmt::format("cannot join DDS domain {} on {}", options_.domain,
                                    options_.addresses.empty() ? "any interface" : join(options_.addresses, ", ")),
                        "check that the interface is up; `gridspace doctor` looks at the usual causes");
        }
        publisher_ = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
        subscriber_ = participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
        return {};
    }

    Result<std::unique_ptr<RawWriter>> create_writer(std::string const& topic_name, Codec const& codec) override {
        auto qos = writer_profile(topic_name);
        return qos ? make_writer(topic_name, codec, *qos) : std::unexpected{qos.error()};
    }
    Result<std::unique_ptr<RawReader>> create_reader(std::string const& topic_name, Codec const& codec,
                                                     SampleHandler handler) override {
        auto qos = reader_profile(topic_name);
        return qos ? make_reader(topic_name, codec, *qos, std::move(handler), false) : std::unexpected{qos.error()};
    }
    Result<std::unique_ptr<RawWriter>> create_writer_like(std::string const& topic_name, Codec const& codec,
                                                          EndpointQos const& like, std::int32_t depth) {
        auto qos = writer_profile("default");
        if (!qos) {
            return std::unexpected{qos.error()};
        }
        apply(like, depth, *qos);
        return make_writer(topic_name, codec, *qos);
    }
    Result<std::unique_ptr<RawReader>> create_reader_like(std::string const& topic_name, Codec const& codec,
                                                          EndpointQos const& like, SampleHandler handler) {
        auto qos = reader_profile("default");
        if (!qos) {
            return std::unexpected{qos.error()};
        }
        apply(like, *qos);
        auto* const subscriber = subscriber_for(like.partitions);
        if (subscriber == nullptr) {
            return fail(ExitCode::environment,
                        fmt::format("DDS refused a subscriber in the partitions [{}]", join(like.partitions, ", ")));
        }
        return make_reader(topic_name, codec, *qos, std::move(handler), true, subscriber);
    }

    [[nodiscard]] Peer peer(std::uint32_t index) const override { return directory_.peer(index); }
    [[nodiscard]] bool hears(Peer const& peer) const override { return directory_.hears(peer); }
    [[nodiscard]] std::string refused_datagrams() const override { return gate_->text(); }
    void on_change(std::function<void()> callback) override { directory_.on_change(std::move(callback)); }
    [[nodiscard]] std::vector<std::uint32_t> here() const override { return directory_.here(); }
    [[nodiscard]] bool is_here(std::uint32_t peer) const override { return directory_.is_here(peer); }
    [[nodiscard]] std::vector<Peer> known_on(std::string const& topic, bool writers) const override {
        std::vector<Peer> out;
        for (auto const& prefix : endpoints_.on(topic, writers)) {
            out.push_back(directory_.peer_of(prefix));
        }
        return out;
    }
    void on_departure(std::function<void(std::uint32_t, bool)> callback) override {
        directory_.on_departure(std::move(callback));
    }
    void leave_at_once() override { directory_.leaves_at_once = true; }

  private:
    /// Fast DDS keeps one set of profiles for the whole process, by name: participants with another file take turns.
    static std::mutex& profiles_mutex() {
        static std::mutex mutex;
        return mutex;
    }
    Result<void> load_profiles() const {
        static std::filesystem::path loaded;
        if (loaded == options_.qos_file) {
            return {};
        }
        if (!loaded.empty()) {
            eprosima::fastrtps::xmlparser::XMLProfileManager::DeleteInstance();
        }
        loaded.clear();
        if (dds::DomainParticipantFactory::get_instance()->load_XML_profiles_file(options_.qos_file.string()) !=
            ReturnCode_t::RETCODE_OK) {
            return fail(ExitCode::usage, fmt::format("cannot read the QoS profiles '{}'", options_.qos_file.string()),
                        "the file must exist and be valid Fast DDS XML");
        }
        loaded = options_.qos_file;
        return {};
    }

    Result<dds::DataWriterQos> writer_profile(std::string const& topic_name) const {
        std::lock_guard const lock{profiles_mutex()};
        if (auto ok = load_profiles(); !ok) {
            return std::unexpected{ok.error()};
        }
        dds::DataWriterQos qos;
        if (publisher_->get_datawriter_qos_from_profile(topic_name, qos) != ReturnCode_t::RETCODE_OK &&
            publisher_->get_datawriter_qos_from_profile("default", qos) != ReturnCode_t::RETCODE_OK) {
            return fail(ExitCode::usage, fmt::format("'{}' has no data_writer profile named '{}', and no 'default'",
                                                     options_.qos_file.string(), topic_name));
        }
        return qos;
    }
    Result<dds::DataReaderQos> reader_profile(std::string const& topic_name) const {
        std::lock_guard const lock{profiles_mutex()};
        if (auto ok = load_profiles(); !ok) {
            return std::unexpected{ok.error()};
        }
        dds::DataReaderQos qos;
        if (subscriber_->get_datareader_qos_from_profile(topic_name, qos) != ReturnCode_t::RETCODE_OK &&
            subscriber_->get_datareader_qos_from_profile("default", qos) != ReturnCode_t::RETCODE_OK) {
            return fail(ExitCode::usage, fmt::format("'{}' has no data_reader profile named '{}', and no 'default'",
                                                     options_.qos_file.string(), topic_name));
        }
        return qos;
    }

    Result<std::unique_ptr<RawWriter>> make_writer(std::string const& topic_name, Codec const& codec,
                                                   dds::DataWriterQos& qos) {
        auto topic = find_topic(topic_name, codec);
        if (!topic) {
            return std::unexpected{topic.error()};
        }
        qos.endpoint().history_memory_policy =
            codec.max_size != 0 ? rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE : rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
        auto writer = std::make_unique<DdsWriter>(directory_, publisher_, codec);
        if (!writer->open(*topic, qos)) {
            return fail(ExitCode::usage, fmt::format("DDS refused the writer of topic '{}'", topic_name),
                        secured_ ? "'" + options_.process + "' has no right to publish it: it does not declare that"
                                 : "its QoS profile is not consistent (depth against resource limits?)");
        }
        return writer;
    }
    Result<std::unique_ptr<RawReader>> make_reader(std::string const& topic_name, Codec const& codec,
                                                   dds::DataReaderQos& qos, SampleHandler handler, bool ignore_own,
                                                   dds::Subscriber* subscriber = nullptr) {
        auto topic = find_topic(topic_name, codec);
        if (!topic) {
            return std::unexpected{topic.error()};
        }
        qos.endpoint().history_memory_policy =
            codec.max_size != 0 ? rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE : rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
        give_own_address(qos.endpoint());
        auto reader = std::make_unique<DdsReader>(directory_, subscriber != nullptr ? subscriber : subscriber_,
                                                  std::move(handler));
        if (ignore_own) {
            reader->ignore(participant_->guid().guidPrefix);
        }
        if (!reader->open(*topic, qos)) {
            return fail(ExitCode::usage, fmt::format("DDS refused the reader of topic '{}'", topic_name),
                        secured_
                            ? "'" + options_.process + "' has no right to subscribe to it: it does not declare that"
                            : "its QoS profile is not consistent (depth against resource limits?)");
        }
        return reader;
    }

    /// A reader whose profile has a multicast address only would have no other: what is meant for it alone, like each
    /// first heartbeat and what is sent again, would go to the whole group.
    void give_own_address(dds::RTPSEndpointQos& endpoint) const {
        if (endpoint.multicast_locator_list.empty() || !endpoint.unicast_locator_list.empty() || *samples_port_ == 0) {
            return;
        }
        for (std::string const& address : options_.addresses) {
            rtps::Locator_t locator;
            rtps::IPLocator::setIPv4(locator, address);
            rtps::IPLocator::setPhysicalPort(locator, *samples_port_);
            endpoint.unicast_locator_list.push_back(locator);
        }
    }

    /// Partitions are a matter of subscribers: there is one for each list of them.
    dds::Subscriber* subscriber_for(std::vector<std::string> const& partitions) {
        if (partitions.empty()) {
            return subscriber_;
        }
        dds::Subscriber*& subscriber = partitioned_[partitions];
        if (subscriber == nullptr) {
            dds::SubscriberQos qos = dds::SUBSCRIBER_QOS_DEFAULT;
            for (std::string const& name : partitions) {
                qos.partition().push_back(name.c_str());
            }
            subscriber = participant_->create_subscriber(qos);
        }
        return subscriber;
    }

    /// However many participants and endpoints somebody invents: memory for so many, and no more.
    static void bound_the_others(dds::DomainParticipantQos& qos) {
        auto& allocation = qos.allocation();
        allocation.participants.maximum = rtps_guard::KnownParticipants::kMax;
        // The library bounds the sum over all participants: this times the above.
        allocation.readers.maximum = allocation.writers.maximum = 16;
    }

    /// The profile's transports, on the configured interfaces only, each with a cork.
    void prepare_transports(dds::DomainParticipantQos& qos) {
        using eprosima::fastrtps::rtps::DiscoveryProtocol_t;
        auto const protocol = qos.wire_protocol().builtin.discovery_config.discoveryProtocol;
        gate_ =
            std::make_shared<rtps_guard::Gate>(rtps_guard::Rules{protocol == DiscoveryProtocol_t::SIMPLE, secured_});
        for (auto& transport : qos.transport().user_transports) {
            using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
            if (auto const udp = std::dynamic_pointer_cast<UDPv4TransportDescriptor>(transport); udp != nullptr) {
                auto own = std::make_shared<UDPv4TransportDescriptor>(*udp); // the profile's is shared
                if (!options_.addresses.empty()) {
                    own->interfaceWhiteList = options_.addresses;
                }
                auto corked = std::make_shared<CorkedTransportDescriptor>(own, gate_);
                corked->interfaces = options_.addresses;
                corked->receive_buffer = udp->receiveBufferSize;
                corked->samples_port = samples_port_;
                transport = std::move(corked);
            }
        }
    }

    /// It announces itself to them instead of the multicast group, and hears that group all the same.
    Result<void> look_for_peers(dds::DomainParticipantQos& qos) const {
        auto& builtin = qos.wire_protocol().builtin;
        for (std::string const& peer : options_.peers) {
            std::vector<std::string> const parts = split(peer, ':');
            rtps::Locator_t locator;
            long const port = parts.size() == 2 ? std::strtol(parts[1].c_str(), nullptr, 10) : 0;
            if (port < 1 || port > 65535 || !rtps::IPLocator::setIPv4(locator, parts[0]) ||
                !rtps::IPLocator::setPhysicalPort(locator, static_cast<std::uint16_t>(port))) {
                return fail(ExitCode::usage, fmt::format("the peer '{}' is no ADDRESS:PORT", peer));
            }
            builtin.initialPeersList.push_back(locator);
        }
        return {};
    }

    Result<dds::Topic*> find_topic(std::string const& name, Codec const& codec) {
        std::string const type_name{codec.type_name};
        if (types_.insert(type_name).second) {
            dds::TypeSupport const type{new PayloadType{codec}};
            if (type.register_type(participant_) != ReturnCode_t::RETCODE_OK) {
                return fail(ExitCode::usage, fmt::format("DDS refused the type '{}'", type_name));
            }
        }
        if (auto const it = topics_.find(name); it != topics_.end()) {
            if (it->second->get_type_name() == type_name) {
                return it->second;
            }
            // Nobody here may use it any longer: who had it with another type has left.
            if (participant_->delete_topic(it->second) != ReturnCode_t::RETCODE_OK) {
                return fail(ExitCode::usage,
                            fmt::format("topic '{}' carries {}, not {}", name, it->second->get_type_name(), type_name));
            }
            topics_.erase(it);
        }
        dds::Topic* topic = participant_->create_topic(name, type_name, dds::TOPIC_QOS_DEFAULT);
        if (topic == nullptr) {
            return fail(ExitCode::usage, fmt::format("DDS refused the topic '{}' of type {}", name, type_name));
        }
        topics_[name] = topic;
        return topic;
    }

    ParticipantOptions options_;
    bool secured_{false};
    std::shared_ptr<rtps_guard::Gate> gate_{std::make_shared<rtps_guard::Gate>()};
    std::shared_ptr<std::atomic<std::uint16_t>> samples_port_{std::make_shared<std::atomic<std::uint16_t>>()};
    Directory directory_;
    KnownEndpoints endpoints_;
    ParticipantListener listener_;
    dds::DomainParticipant* participant_{nullptr};
    dds::Publisher* publisher_{nullptr};
    dds::Subscriber* subscriber_{nullptr};
    std::map<std::vector<std::string>, dds::Subscriber*> partitioned_; // by their partitions
    std::set<std::string> types_;
    std::map<std::string, dds::Topic*> topics_;
};

} // namespace

Result<std::unique_ptr<Participant>> Participant::create(ParticipantOptions options, DiscoveryObserver* observer) {
    remember_thread_ids();
    auto participant = std::make_unique<FastDdsParticipant>(std::move(options), observer);
    if (auto opened = participant->open(); !opened) {
        return std::unexpected{opened.error()};
    }
    return participant;
}

Result<std::unique_ptr<Participant>> join_over_tcp(ParticipantOptions options, TcpLink const& link,
                                                   DiscoveryObserver* observer) {
    auto participant = std::make_unique<FastDdsParticipant>(std::move(options), observer);
    if (auto opened = participant->open(&link); !opened) {
        return std::unexpected{opened.error()};
    }
    return participant;
}

Result<std::unique_ptr<RawReader>> create_reader_like(Participant& participant, std::string const& topic,
                                                      Codec const& codec, EndpointQos const& like,
                                                      SampleHandler handler) {
    return static_cast<FastDdsParticipant&>(participant).create_reader_like(topic, codec, like, std::move(handler));
}

Result<std::unique_ptr<RawWriter>> create_writer_like(Participant& participant, std::string const& topic,
                                                      Codec const& codec, EndpointQos const& like, std::int32_t depth) {
    return static_cast<FastDdsParticipant&>(participant).create_writer_like(topic, codec, like, depth); // the only kind
}

} // namespace gridspace::bus
