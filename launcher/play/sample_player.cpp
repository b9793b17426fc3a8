// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/play/sample_player.hpp"

#include "bus/topics.hpp"
#include "common/log.hpp"
#include "common/text.hpp"
#include "recorder/mcap/mcap_reader.hpp"

#include <algorithm>
#include <atomic>
#include <catalog.h>
#include <fmt/format.h>
#include <optional>
#include <set>

namespace gridspace::play {
namespace {

constexpr std::chrono::milliseconds kPatience{2000}; ///< then it is said who is waited for
constexpr std::int64_t kLate = 20'000'000;           ///< what is later comes in a burst, faster than it was recorded
constexpr std::uint32_t kWindow = 48; ///< samples of one writer on their way; the histories of qos/player.xml hold more

/// Topics that say how others are to be read: needed from the first sample on.
bool is_catalogue(std::string const& topic) {
    return topic == "signal_catalog" || topic == "member_status";
}

} // namespace

/// One channel of the recording: a topic as one process wrote it.
struct SamplePlayer::Lane {
    mcap::Channel channel;
    mcap::Schema schema;
    idl::Model model;
    std::optional<idl::KeyFinder> key;
    std::unique_ptr<bus::RawWriter> writer;
    std::uint32_t window{kWindow}, on_their_way{0};
    std::uint64_t* total{nullptr};
};

SamplePlayer::~SamplePlayer() {
    lanes_.clear();
    catalogues_.clear();
    participants_.clear();
}

Result<std::unique_ptr<SamplePlayer>> SamplePlayer::open(std::filesystem::path const& recording,
                                                         PlayOptions const& options) {
    std::unique_ptr<SamplePlayer> player{new SamplePlayer};
    player->recording_ = recording;
    if (auto ok = player->scan(options); !ok) {
        return std::unexpected{ok.error()};
    }
    if (auto ok = player->join(options); !ok) {
        return std::unexpected{ok.error()};
    }
    return player;
}

Result<void> SamplePlayer::scan(PlayOptions const& options) {
    std::set<std::uint16_t> left_out;
    bool any = false;
    auto const outcome = mcap::read_messages(recording_, [&](mcap::Message const& m) {
        if (left_out.contains(m.channel.id)) {
            return !wire::stopped();
        }
        if (!lanes_.contains(m.channel.id)) {
            bool const wanted = options.topics.empty() || std::any_of(options.topics.begin(), options.topics.end(),
                                                                      [&](std::string const& pattern) {
                                                                          return matches_glob(pattern, m.channel.topic);
                                                                      });
            if (!wanted || m.channel.message_encoding != "cdr") {
                left_out.insert(m.channel.id);
                return true;
            }
            auto lane = std::make_unique<Lane>();
            lane->channel = m.channel;
            lane->schema = m.schema;
            lanes_[m.channel.id] = std::move(lane);
        }
        auto const time = static_cast<std::int64_t>(m.time_ns);
        first_ns_ = any ? std::min(first_ns_, time) : time;
        last_ns_ = any ? std::max(last_ns_, time) : time;
        any = true;
        return !wire::stopped();
    });
    if (!outcome) {
        return std::unexpected{outcome.error()};
    }
    if (!outcome->complete && !wire::stopped()) {
        note_ = outcome->note;
    }
    if (!any) {
        return fail(
            ExitCode::usage,
            fmt::format("'{}' holds no sample to play{}", recording_.string(), note_.empty() ? "" : ": " + note_),
            options.topics.empty() ? "" : "`gridspace info` lists its topics");
    }
    return {};
}

Result<void> SamplePlayer::join(PlayOptions const& options) {
    std::map<std::int64_t, std::set<std::string>> published;
    for (auto& [id, lane] : lanes_) {
        auto const named = lane->channel.metadata.find("process");
        std::string const process = named == lane->channel.metadata.end() ? "player" : named->second;
        bool const studied = !bus::is_management_topic(lane->channel.topic);
        std::int64_t const domain = studied && options.data_domain >= 0 ? options.data_domain : options.domain;
        auto& participant = participants_[{process, domain}];
        if (participant == nullptr) {
            bus::ParticipantOptions joining;
            joining.process = process;
            joining.program = "gridspace-player";
            joining.domain = static_cast<int>(domain);
            joining.qos_file = options.qos;
            joining.addresses = options.addresses;
            auto joined = bus::Participant::create(std::move(joining));
            if (!joined) {
                return std::unexpected{joined.error()};
            }
            participant = std::move(*joined);
        }
        bus::Codec codec; // octets, whatever the type
        codec.type_name = lane->schema.name;
        if (auto model = idl::parse(lane->schema.data)) {
            if (auto const type = model->find(lane->schema.name)) {
                codec.keyed = model->is_keyed(*type);
                lane->model = std::move(*model);
                if (codec.keyed) {
                    lane->key.emplace(lane->model, *type);
                }
            }
        }
        auto writer = participant->create_writer(lane->channel.topic, codec);
        if (!writer) {
            return std::unexpected{writer.error()};
        }
        lane->writer = std::move(*writer);
        lane->window = is_catalogue(lane->channel.topic) ? 1 : kWindow; // of those one sample is kept
        lane->total = &totals_.by_topic[lane->channel.topic];
        if (lane->schema.encoding == "omgidl" && !lane->schema.data.empty() &&
            published[domain].insert(lane->schema.name).second) {
            auto catalogue = participant->create_writer("type_catalog", bus::codec_of<TypeCatalogEntry>());
            if (!catalogue) {
                return std::unexpected{catalogue.error()};
            }
            TypeCatalogEntry entry;
            entry.type_name(lane->schema.name.c_str());
            entry.idl(lane->schema.data);
            (void)(*catalogue)->write(&entry, std::nullopt);
            catalogues_.push_back(std::move(*catalogue));
        }
    }
    return {};
}

std::size_t SamplePlayer::topics() const {
    return totals_.by_topic.size();
}

void SamplePlayer::wait_for_readers() {
    std::string told;
    while (!wire::stopped()) {
        std::string missing;
        for (auto const& [id, lane] : lanes_) {
            if (lane->writer->matched().empty()) {
                missing += (missing.empty() ? "" : ", ") + lane->channel.topic;
            }
        }
        if (missing.empty()) {
            return;
        }
        if (std::exchange(told, missing) != missing) {
            log::info("waiting for readers of {}", missing);
        }
        wire::sleep_until(wire::monotonic_ns() + 20'000'000);
    }
}

void SamplePlayer::wait_until_quiet() {
    constexpr std::int64_t kQuiet = 500'000'000, kLongest = 5'000'000'000;
    auto const last_change = std::make_shared<std::atomic<std::int64_t>>(wire::monotonic_ns()); // outlives a late call
    for (auto const& [key, participant] : participants_) {
        participant->on_change([last_change] { *last_change = wire::monotonic_ns(); });
    }
    std::int64_t const begin = wire::monotonic_ns();
    for (std::int64_t now = begin; !wire::stopped() && now < *last_change + kQuiet && now < begin + kLongest;
         now = wire::monotonic_ns()) {
        wire::sleep_until(now + 20'000'000);
    }
    for (auto const& [key, participant] : participants_) {
        participant->on_change({});
    }
}

void SamplePlayer::write(Lane& lane, std::span<std::byte const> cdr, bool in_a_hurry) {
    bus::KeyHash hash;
    bus::KeyHash const* key_hash = nullptr;
    if (lane.key) {
        if (auto const key = lane.key->key_of(cdr)) {
            hash = bus::key_hash(*key, lane.key->is_short());
            key_hash = &hash;
        }
    }
    if (lane.writer->write_cdr(cdr, std::nullopt, key_hash)) {
        ++totals_.samples;
        ++*lane.total;
    } else {
        ++totals_.refused;
    }
    if (++lane.on_their_way >= lane.window) { // a reader that lags shall not lose any
        lane.on_their_way = 0;
        if (in_a_hurry || lane.window == 1) {
            wait_for_readers_of(lane);
        }
    }
}

void SamplePlayer::wait_for_readers_of(Lane const& lane) {
    constexpr std::chrono::milliseconds kRound{100}; // a signal ends the wait
    std::int64_t const begin = wire::monotonic_ns();
    bool said = false;
    while (!lane.writer->wait_acknowledged(kRound) && !wire::stopped()) {
        if (said || wire::monotonic_ns() - begin < std::chrono::nanoseconds{kPatience}.count()) {
            continue;
        }
        said = true;
        ++totals_.behind;
        std::vector<std::string> readers;
        for (bus::Peer const& peer : lane.writer->matched()) {
            readers.push_back(peer.process.empty() ? "somebody" : peer.process);
        }
        std::sort(readers.begin(), readers.end());
        readers.erase(std::unique(readers.begin(), readers.end()), readers.end());
        log::warning("not every reader of {} takes what is played; it waits for them while they are there: {}",
                     lane.channel.topic, gridspace::join(readers, ", "));
    }
}

Result<void> SamplePlayer::play(Pace const& pace, std::int64_t from_ns, std::int64_t to_ns) {
    auto const outcome = mcap::read_messages(recording_, [&](mcap::Message const& m) {
        auto const lane = lanes_.find(m.channel.id);
        auto const time = static_cast<std::int64_t>(m.time_ns);
        if (lane == lanes_.end() || time > to_ns) {
            return !wire::stopped();
        }
        if (time < from_ns) {
            if (is_catalogue(m.channel.topic)) {
                write(*lane->second, m.data, true);
            }
            return !wire::stopped();
        }
        std::int64_t const late = pace.wait_until(time);
        totals_.worst_late_ns = std::max(totals_.worst_late_ns, late);
        if (time == last_ns_ && m.channel.topic == "simulation_clock") {
            finish(); // readers end with the last clock sample: they shall have the rest
        }
        if (!wire::stopped()) {
            write(*lane->second, m.data, !pace.is_paced() || late > kLate);
        }
        return !wire::stopped();
    });
    return outcome ? Result<void>{} : std::unexpected{outcome.error()};
}

void SamplePlayer::finish() {
    for (auto const& [id, lane] : lanes_) {
        if (!wire::stopped()) {
            wait_for_readers_of(*lane);
        }
    }
}

} // namespace gridspace::play
