// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/directory_impl.hpp"
#include "bus/fastdds_type.hpp"
#include "bus/sample_stamp.hpp"
#include "common/log.hpp"

#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>

/// The readers and writers behind bus/participant.hpp.
namespace gridspace::bus {

namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::types::ReturnCode_t;

class DdsWriter final : public RawWriter, private dds::DataWriterListener {
  public:
    DdsWriter(Directory& directory, dds::Publisher* publisher, Codec const& codec)
        : directory_{directory}, publisher_{publisher}, codec_{codec} {}
    ~DdsWriter() override {
        if (writer_ != nullptr) {
            writer_->set_listener(nullptr);
            constexpr std::chrono::milliseconds kPatience{200}; // two heartbeats
            if (!directory_.leaves_at_once && !wait_acknowledged(kPatience)) {
                directory_.leaves_at_once = true;
            }
            // 2.9.1 gives the samples back one by one while the periodic heartbeat may still walk through them: it
            // meets one without a number, looks for holes up to it and never ends. In an empty history there are no
            // holes.
            std::size_t removed = 0;
            (void)writer_->clear_history(&removed);
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
    bool write_cdr(std::span<std::byte const> cdr, std::optional<std::int64_t> source_ns,
                   KeyHash const* key_hash) override {
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
        std::int64_t const ns = stamp_of(*source_ns);
        stamp.seconds = static_cast<std::int32_t>(ns / 1'000'000'000);
        stamp.nanosec = static_cast<std::uint32_t>(ns % 1'000'000'000);
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

class DdsReader final : public RawReader, private dds::DataReaderListener {
  public:
    DdsReader(Directory& directory, dds::Subscriber* subscriber, SampleHandler handler)
        : directory_{directory}, subscriber_{subscriber}, handler_{std::move(handler)} {}
    ~DdsReader() override {
        if (reader_ != nullptr) {
            reader_->set_listener(nullptr);
            subscriber_->delete_datareader(reader_);
        }
    }
    /// Samples of this participant are not handed on.
    void ignore(rtps::GuidPrefix_t const& own) { ignored_ = own; }
    bool open(dds::Topic* topic, dds::DataReaderQos const& qos) {
        dds::StatusMask mask = dds::StatusMask::data_available();
        mask << dds::StatusMask::subscription_matched();
        reader_ = subscriber_->create_datareader(topic, qos, this, mask);
        return reader_ != nullptr;
    }
    [[nodiscard]] std::vector<Peer> matched() const override { return matches_.peers(directory_); }

  private:
    void on_data_available(dds::DataReader* reader) override {
        // Unicast and multicast arrive on different threads; samples are handed on one at a time, in the order of the
        // writer.
        std::lock_guard const lock{take_mutex_};
        dds::SampleInfo info;
        while (reader->take_next_sample(&incoming_, &info) == ReturnCode_t::RETCODE_OK) {
            if (!info.valid_data) {
                continue; // an instance went away; departures are seen by the participant
            }
            SampleHeader header;
            auto const& guid = info.sample_identity.writer_guid();
            if (guid.guidPrefix == ignored_) {
                continue;
            }
            if (std::size_t const index = writer_index(guid); index < kMaxWriters) {
                header.source = static_cast<std::uint32_t>(index);
            } else {
                continue;
            }
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
    /// kMaxWriters: there is no room for it.
    std::size_t writer_index(rtps::GUID_t const& guid) {
        auto const known = std::ranges::find(writers_, guid, &KnownWriter::guid);
        if (known == writers_.end() && writers_.size() >= kMaxWriters) {
            if (!std::exchange(reported_, true)) {
                log::warning("topic '{}': more than {} writers have come; new ones are not heard",
                             reader_->get_topicdescription()->get_name(), kMaxWriters);
            }
            return kMaxWriters;
        }
        if (known == writers_.end()) {
            writers_.push_back({guid, directory_.index_of(guid.guidPrefix)});
            return writers_.size() - 1;
        }
        return static_cast<std::size_t>(known - writers_.begin());
    }

    static constexpr std::size_t kMaxWriters = 16'384; ///< over all of its life
    struct KnownWriter {
        rtps::GUID_t guid;
        std::uint32_t peer;
    };

    Directory& directory_;
    dds::Subscriber* subscriber_;
    SampleHandler handler_;
    dds::DataReader* reader_{nullptr};
    rtps::GuidPrefix_t ignored_; ///< unknown: nobody
    Matches matches_;
    std::mutex take_mutex_; // guards the next three
    Incoming incoming_;
    std::vector<KnownWriter> writers_;
    bool reported_{false}; ///< that there is no room
};

} // namespace gridspace::bus
