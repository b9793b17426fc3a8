// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/participant.hpp"

#include "bus/corked_transport.hpp"
#include "bus/discovery_impl.hpp"
#include "bus/fastdds_type.hpp"
#include "common/log.hpp"
#include "common/text.hpp"

#include <algorithm>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fmt/format.h>
#include <map>
#include <mutex>
#include <set>

namespace gridspace::bus {
namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
using eprosima::fastrtps::types::ReturnCode_t;

/// Who is behind a GUID prefix; and tells the owner about changes. Shared by the listeners of a participant.
class Directory {
  public:
    std::uint32_t index_of(rtps::GuidPrefix_t const& prefix) {
        std::lock_guard const lock{mutex_};
        return locked_index(prefix);
    }
    Peer peer(std::uint32_t index) const {
        std::lock_guard const lock{mutex_};
        return index < peers_.size() ? peers_[index] : Peer{};
    }
    void announce(rtps::GuidPrefix_t const& prefix, Peer peer) {
        {
            std::lock_guard const lock{mutex_};
            peers_[locked_index(prefix)] = std::move(peer);
        }
        changed();
    }
    void depart(rtps::GuidPrefix_t const& prefix, bool clean) {
        std::function<void(Peer const&, bool)> callback;
        Peer who;
        {
            std::lock_guard const lock{mutex_};
            callback = on_departure_;
            who = peers_[locked_index(prefix)];
        }
        if (callback) {
            callback(who, clean);
        }
        changed();
    }
    void changed() {
        std::function<void()> callback;
        {
            std::lock_guard const lock{mutex_};
            callback = on_change_;
        }
        if (callback) {
            callback();
        }
    }
    void on_change(std::function<void()> callback) {
        std::lock_guard const lock{mutex_};
        on_change_ = std::move(callback);
    }
    void on_departure(std::function<void(Peer const&, bool)> callback) {
        std::lock_guard const lock{mutex_};
        on_departure_ = std::move(callback);
    }

  private:
    std::uint32_t locked_index(rtps::GuidPrefix_t const& prefix) {
        auto const [it, added] = index_.try_emplace(prefix, static_cast<std::uint32_t>(peers_.size()));
        if (added) {
            peers_.emplace_back();
        }
        return it->second;
    }

    mutable std::mutex mutex_;
    std::map<rtps::GuidPrefix_t, std::uint32_t> index_;
    std::vector<Peer> peers_;
    std::function<void()> on_change_;
    std::function<void(Peer const&, bool)> on_departure_;
};

/// The endpoints that one endpoint is matched with.
class Matches {
  public:
    void update(rtps::GUID_t const& guid, int change) {
        std::lock_guard const lock{mutex_};
        if (change > 0) {
            guids_.insert(guid);
        } else {
            guids_.erase(guid);
        }
    }
    std::vector<Peer> peers(Directory& directory) const {
        std::vector<Peer> out;
        std::lock_guard const lock{mutex_};
        for (rtps::GUID_t const& guid : guids_) {
            out.push_back(directory.peer(directory.index_of(guid.guidPrefix)));
        }
        return out;
    }

  private:
    mutable std::mutex mutex_;
    std::set<rtps::GUID_t> guids_;
};

constexpr std::string_view kUserDataMark = "gridspace/1";

std::string user_data_of(ParticipantOptions const& options) {
    return fmt::format("{};process={};incarnation={};program={}", kUserDataMark, options.process, options.incarnation,
                       options.program);
}

/// A participant of another make may take part as a member: its entity name is then its process name.
Peer peer_of(rtps::ParticipantProxyData const& data) {
    Peer peer{std::string{data.m_participantName.c_str()}, 0, ""};
    std::string const text{data.m_userData.begin(), data.m_userData.end()};
    if (!text.starts_with(kUserDataMark)) {
        return peer;
    }
    for (std::string const& part : split(text, ';')) {
        if (part.starts_with("process=")) {
            peer.process = part.substr(8);
        } else if (part.starts_with("incarnation=")) {
            peer.incarnation = static_cast<std::uint32_t>(std::strtoul(part.c_str() + 12, nullptr, 10));
        } else if (part.starts_with("program=")) {
            peer.program = part.substr(8);
        }
    }
    return peer;
}

class ParticipantListener final : public dds::DomainParticipantListener {
  public:
    ParticipantListener(Directory& directory, DiscoveryObserver* observer)
        : directory_{directory}, observer_{observer} {}
    void on_participant_discovery(dds::DomainParticipant*, rtps::ParticipantDiscoveryInfo&& found) override {
        using Info = rtps::ParticipantDiscoveryInfo;
        rtps::GuidPrefix_t const& prefix = found.info.m_guid.guidPrefix;
        if (observer_ != nullptr) {
            if (found.status == Info::REMOVED_PARTICIPANT || found.status == Info::DROPPED_PARTICIPANT) {
                observer_->participant_gone(id_of(prefix), found.status == Info::REMOVED_PARTICIPANT);
            } else {
                observer_->participant_found({id_of(prefix), peer_of(found.info), addresses_of(found.info)});
            }
        }
        switch (found.status) {
        case Info::DISCOVERED_PARTICIPANT:
        case Info::CHANGED_QOS_PARTICIPANT:
            directory_.announce(prefix, peer_of(found.info));
            break;
        case Info::REMOVED_PARTICIPANT:
            directory_.depart(prefix, true);
            break;
        case Info::DROPPED_PARTICIPANT:
            directory_.depart(prefix, false);
            break;
        }
    }

    void on_publisher_discovery(dds::DomainParticipant*, rtps::WriterDiscoveryInfo&& found) override {
        if (observer_ != nullptr) {
            if (found.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER) {
                observer_->endpoint_gone(id_of(found.info.guid()));
            } else {
                observer_->endpoint_found(endpoint_of(found.info, true));
            }
        }
    }
    void on_subscriber_discovery(dds::DomainParticipant*, rtps::ReaderDiscoveryInfo&& found) override {
        if (observer_ != nullptr) {
            if (found.status == rtps::ReaderDiscoveryInfo::REMOVED_READER) {
                observer_->endpoint_gone(id_of(found.info.guid()));
            } else {
                observer_->endpoint_found(endpoint_of(found.info, false));
            }
        }
    }

  private:
    Directory& directory_;
    DiscoveryObserver* observer_;
};

class Writer final : public RawWriter, private dds::DataWriterListener {
  public:
    Writer(Directory& directory, dds::Publisher* publisher, Codec const& codec)
        : directory_{directory}, publisher_{publisher}, codec_{codec} {}
    ~Writer() override {
        if (writer_ != nullptr) {
            writer_->set_listener(nullptr);
            publisher_->delete_datawriter(writer_);
        }
    }
    bool open(dds::Topic* topic, dds::DataWriterQos const& qos) {
        writer_ = publisher_->create_datawriter(topic, qos, this, dds::StatusMask::publication_matched());
        return writer_ != nullptr;
    }
    bool write(void const* sample, std::optional<std::int64_t> source_ns) override {
        Outgoing out;
        out.codec = &codec_;
        out.sample = sample;
        return send(out, source_ns);
    }
    bool write_cdr(std::span<std::byte const> cdr, std::optional<std::int64_t> source_ns, KeyHash const* key_hash) override {
        Outgoing out;
        out.codec = &codec_;
        out.cdr = cdr;
        out.key_hash = key_hash;
        return send(out, source_ns);
    }
    [[nodiscard]] std::vector<Peer> matched() const override { return matches_.peers(directory_); }
    bool wait_acknowledged(std::chrono::milliseconds deadline) override {
        auto const ms = deadline.count();
        eprosima::fastrtps::Duration_t const limit{static_cast<std::int32_t>(ms / 1000),
                                                   static_cast<std::uint32_t>(ms % 1000) * 1'000'000U};
        return writer_->wait_for_acknowledgments(limit) == ReturnCode_t::RETCODE_OK;
    }

  private:
    bool send(Outgoing& out, std::optional<std::int64_t> source_ns) {
        if (!source_ns) {
            return writer_->write(&out);
        }
        eprosima::fastrtps::Time_t stamp;
        stamp.seconds = static_cast<std::int32_t>(*source_ns / 1'000'000'000);
        stamp.nanosec = static_cast<std::uint32_t>(*source_ns % 1'000'000'000);
        return writer_->write_w_timestamp(&out, rtps::c_InstanceHandle_Unknown, stamp) == ReturnCode_t::RETCODE_OK;
    }
    void on_publication_matched(dds::DataWriter*, dds::PublicationMatchedStatus const& status) override {
        matches_.update(rtps::iHandle2GUID(status.last_subscription_handle), status.current_count_change);
        directory_.changed();
    }

    Directory& directory_;
    dds::Publisher* publisher_;
    Codec codec_;
    dds::DataWriter* writer_{nullptr};
    Matches matches_;
};

class Reader final : public RawReader, private dds::DataReaderListener {
  public:
    Reader(Directory& directory, dds::Subscriber* subscriber, SampleHandler handler)
        : directory_{directory}, subscriber_{subscriber}, handler_{std::move(handler)} {}
    ~Reader() override {
        if (reader_ != nullptr) {
            reader_->set_listener(nullptr);
            subscriber_->delete_datareader(reader_);
        }
    }
    bool open(dds::Topic* topic, dds::DataReaderQos const& qos) {
        dds::StatusMask mask = dds::StatusMask::data_available();
        mask << dds::StatusMask::subscription_matched();
        reader_ = subscriber_->create_datareader(topic, qos, this, mask);
        return reader_ != nullptr;
    }
    [[nodiscard]] std::vector<Peer> matched() const override { return matches_.peers(directory_); }

  private:
    void on_data_available(dds::DataReader* reader) override {
        // Unicast and multicast arrive on different threads; samples are handed on one at a time, in the order of the writer.
        std::lock_guard const lock{take_mutex_};
        dds::SampleInfo info;
        while (reader->take_next_sample(&incoming_, &info) == ReturnCode_t::RETCODE_OK) {
            if (!info.valid_data) {
                continue; // an instance went away; departures are seen by the participant
            }
            SampleHeader header;
            auto const& guid = info.sample_identity.writer_guid();
            header.source = writer_index(guid);
            header.peer = writers_[header.source].peer;
            header.writer = guid.entityId.to_uint32();
            header.sequence = info.sample_identity.sequence_number().to64long();
            header.source_ns = info.source_timestamp.to_ns();
            handler_(incoming_.cdr, header);
        }
    }
    void on_subscription_matched(dds::DataReader*, dds::SubscriptionMatchedStatus const& status) override {
        matches_.update(rtps::iHandle2GUID(status.last_publication_handle), status.current_count_change);
        directory_.changed();
    }
    std::uint32_t writer_index(rtps::GUID_t const& guid) {
        for (std::size_t i = 0; i < writers_.size(); ++i) {
            if (writers_[i].guid == guid) {
                return static_cast<std::uint32_t>(i);
            }
        }
        writers_.push_back({guid, directory_.index_of(guid.guidPrefix)});
        return static_cast<std::uint32_t>(writers_.size() - 1);
    }

    struct KnownWriter {
        rtps::GUID_t guid;
        std::uint32_t peer;
    };

    Directory& directory_;
    dds::Subscriber* subscriber_;
    SampleHandler handler_;
    dds::DataReader* reader_{nullptr};
    Matches matches_;
    std::mutex take_mutex_; // guards the next two
    Incoming incoming_;
    std::vector<KnownWriter> writers_;
};

class FastDdsParticipant final : public Participant {
  public:
    FastDdsParticipant(ParticipantOptions options, DiscoveryObserver* observer)
        : options_{std::move(options)}, listener_{directory_, observer} {}

    ~FastDdsParticipant() override {
        if (participant_ == nullptr) {
            return;
        }
        participant_->set_listener(nullptr);
        participant_->delete_contained_entities();
        dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
    }

    Result<void> open() {
        auto* factory = dds::DomainParticipantFactory::get_instance();
        if (factory->load_XML_profiles_file(options_.qos_file.string()) != ReturnCode_t::RETCODE_OK) {
            return fail(ExitCode::usage, fmt::format("cannot read the QoS profiles '{}'", options_.qos_file.string()),
                        "the file must exist and be valid Fast DDS XML");
        }
        dds::DomainParticipantQos qos;
        if (factory->get_participant_qos_from_profile(options_.profile, qos) != ReturnCode_t::RETCODE_OK) {
            return fail(ExitCode::usage, fmt::format("'{}' has no participant profile named '{}'",
                                                     options_.qos_file.string(), options_.profile));
        }
        qos.name(options_.process.c_str());
        std::string const user_data = user_data_of(options_);
        qos.user_data().setValue(std::vector<rtps::octet>{user_data.begin(), user_data.end()});
        prepare_transports(qos);
        participant_ = factory->create_participant(static_cast<std::uint32_t>(options_.domain), qos, &listener_,
                                                   dds::StatusMask::none());
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
        auto topic = find_topic(topic_name, codec);
        if (!topic) {
            return std::unexpected{topic.error()};
        }
        dds::DataWriterQos qos;
        if (publisher_->get_datawriter_qos_from_profile(topic_name, qos) != ReturnCode_t::RETCODE_OK &&
            publisher_->get_datawriter_qos_from_profile("default", qos) != ReturnCode_t::RETCODE_OK) {
            return fail(ExitCode::usage, fmt::format("'{}' has no data_writer profile named '{}', and no 'default'",
                                                     options_.qos_file.string(), topic_name));
        }
        qos.endpoint().history_memory_policy =
            codec.max_size != 0 ? rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE : rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
        auto writer = std::make_unique<Writer>(directory_, publisher_, codec);
        if (!writer->open(*topic, qos)) {
            return fail(ExitCode::usage, fmt::format("DDS refused the writer of topic '{}'", topic_name),
                        "its QoS profile is not consistent (depth against resource limits?)");
        }
        return writer;
    }

    Result<std::unique_ptr<RawReader>> create_reader(std::string const& topic_name, Codec const& codec,
                                                     SampleHandler handler) override {
        auto topic = find_topic(topic_name, codec);
        if (!topic) {
            return std::unexpected{topic.error()};
        }
        dds::DataReaderQos qos;
        if (subscriber_->get_datareader_qos_from_profile(topic_name, qos) != ReturnCode_t::RETCODE_OK &&
            subscriber_->get_datareader_qos_from_profile("default", qos) != ReturnCode_t::RETCODE_OK) {
            return fail(ExitCode::usage, fmt::format("'{}' has no data_reader profile named '{}', and no 'default'",
                                                     options_.qos_file.string(), topic_name));
        }
        qos.endpoint().history_memory_policy =
            codec.max_size != 0 ? rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE : rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
        auto reader = std::make_unique<Reader>(directory_, subscriber_, std::move(handler));
        if (!reader->open(*topic, qos)) {
            return fail(ExitCode::usage, fmt::format("DDS refused the reader of topic '{}'", topic_name),
                        "its QoS profile is not consistent (depth against resource limits?)");
        }
        return reader;
    }

    [[nodiscard]] Peer peer(std::uint32_t index) const override { return directory_.peer(index); }
    void on_change(std::function<void()> callback) override { directory_.on_change(std::move(callback)); }
    void on_departure(std::function<void(Peer const&, bool)> callback) override {
        directory_.on_departure(std::move(callback));
    }

  private:
    /// The profile's transports, on the configured interfaces only, each with a cork.
    void prepare_transports(dds::DomainParticipantQos& qos) const {
        for (auto& transport : qos.transport().user_transports) {
            using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
            if (auto const udp = std::dynamic_pointer_cast<UDPv4TransportDescriptor>(transport); udp != nullptr) {
                auto own = std::make_shared<UDPv4TransportDescriptor>(*udp); // the profile's is shared
                if (!options_.addresses.empty()) {
                    own->interfaceWhiteList = options_.addresses;
                }
                transport = std::make_shared<CorkedTransportDescriptor>(own);
            }
        }
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
            if (it->second->get_type_name() != type_name) {
                return fail(ExitCode::usage,
                            fmt::format("topic '{}' carries {}, not {}", name, it->second->get_type_name(), type_name));
            }
            return it->second;
        }
        dds::Topic* topic = participant_->create_topic(name, type_name, dds::TOPIC_QOS_DEFAULT);
        if (topic == nullptr) {
            return fail(ExitCode::usage, fmt::format("DDS refused the topic '{}' of type {}", name, type_name));
        }
        topics_[name] = topic;
        return topic;
    }

    ParticipantOptions options_;
    Directory directory_;
    ParticipantListener listener_;
    dds::DomainParticipant* participant_{nullptr};
    dds::Publisher* publisher_{nullptr};
    dds::Subscriber* subscriber_{nullptr};
    std::set<std::string> types_;
    std::map<std::string, dds::Topic*> topics_;
};

} // namespace

Result<std::unique_ptr<Participant>> Participant::create(ParticipantOptions options, DiscoveryObserver* observer) {
    auto participant = std::make_unique<FastDdsParticipant>(std::move(options), observer);
    if (auto opened = participant->open(); !opened) {
        return std::unexpected{opened.error()};
    }
    return participant;
}

} // namespace gridspace::bus
