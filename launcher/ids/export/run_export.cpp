// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/export/run_export.hpp"

#include "launcher/ids/export/message_features.hpp"
#include "launcher/ids/scan/capture_scan.hpp"
#include "recorder/pcapng/pcapng_reader.hpp"

#include <charconv>
#include <memory>

namespace gridspace::dataset {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t kMostVantages = 64, kMostStreams = 1024;
constexpr std::string_view kSimulated = "simulated time ";

std::string file_name(std::string const& vantage) {
    std::string out;
    for (char const c : vantage) {
        bool const plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
        out += plain ? c : '.';
    }
    return out;
}

/// Everything of one vantage point.
struct Vantage {
    Vantage(std::string name, fs::path const& stem, pcapng::Writer capture_)
        : capture{std::move(capture_)},
          frames{stem.string() + ".frames.csv", "frame,time_s,port,protocol,stream,altered,attack"},
          samples{stem.string() + ".samples.csv", SampleFeatures::kColumns},
          messages{stem.string() + ".messages.csv", MessageFeatures::kColumns} {
        done.name = std::move(name);
        done.file = stem.filename().string();
    }
    pcapng::Writer capture;
    std::map<std::uint32_t, std::uint32_t> interfaces; ///< of the run's capture, in this one
    CsvFile frames, samples, messages;
    std::map<std::string, SampleFeatures> smv;    ///< by svID
    std::map<std::string, MessageFeatures> goose; ///< by gocbRef
    ExportedRun::Vantage done;
};

class Exporter {
  public:
    Exporter(RunSource const& run, fs::path folder) : run_{run}, folder_{std::move(folder)}, labels_{run} {
        for (streams::Stream const& stream : run.streams) {
            bool const smv = stream.kind == streams::Kind::smv;
            by_name_[{smv, smv ? stream.sv_id : stream.control_block}] = &stream;
        }
    }

    Result<ExportedRun> all(std::function<void(std::uint64_t)> const& progress) {
        if (labels_.has_to_learn()) {
            auto const learnt = read([&](pcapng::Frame const& frame, std::string const& interface) {
                labels_.learn(interface, 1e-9 * static_cast<double>(simulated_ns(frame)), frame.octets);
                return Result<void>{};
            });
            if (!learnt) {
                return std::unexpected{learnt.error()};
            }
        }
        std::uint64_t frames = 0;
        auto const read_all = read([&](pcapng::Frame const& frame, std::string const& interface) {
            if (++frames % 65'536 == 0) {
                progress(frames);
            }
            return take(frame, interface);
        });
        if (!read_all) {
            return std::unexpected{read_all.error()};
        }
        for (auto& [name, vantage] : vantages_) {
            for (auto const& closed : {vantage->capture.close(), vantage->frames.close(), vantage->samples.close(),
                                       vantage->messages.close()}) {
                if (!closed) {
                    return std::unexpected{closed.error()};
                }
            }
            vantage->done.samples = vantage->samples.rows();
            vantage->done.messages = vantage->messages.rows();
            out_.vantages.push_back(vantage->done);
        }
        return std::move(out_);
    }

  private:
    template <class OnFrame>
    Result<void> read(OnFrame const& on_frame) {
        fs::path const file = pcapng::capture_of_run(run_.folder);
        auto reader = pcapng::Reader::open(file);
        if (!reader) {
            return std::unexpected{reader.error()};
        }
        Result<void> said;
        auto const done = reader->each([&](pcapng::Frame const& frame) {
            pcapng::Interface const& interface = reader->interfaces()[frame.interface];
            if (said && interface.link_type == pcapng::kEthernetLink) {
                said = on_frame(frame, interface.name);
            }
        });
        if (!done) {
            return done;
        }
        if (said && reader->truncated()) {
            return fail(ExitCode::usage, fmt::format("'{}' is damaged: it was cut off", file.string()),
                        "run the scenario again");
        }
        return said;
    }

    Result<Vantage*> vantage_of(std::string const& interface) {
        std::string const name = scan::vantage_of(interface);
        auto at = vantages_.find(name);
        if (at == vantages_.end()) {
            if (vantages_.size() >= kMostVantages) {
                return fail(ExitCode::usage, fmt::format("the capture of run '{}' has more than {} vantage points",
                                                         run_.id, kMostVantages));
            }
            fs::path const stem = folder_ / file_name(name);
            auto writer = pcapng::Writer::create(stem.string() + ".pcapng", "gridspace ids export");
            if (!writer) {
                return std::unexpected{writer.error()};
            }
            at = vantages_.emplace(name, std::make_unique<Vantage>(name, stem, std::move(*writer))).first;
        }
        return at->second.get();
    }

    /// Since the start of the run. In real time the capture says it of each frame.
    [[nodiscard]] std::int64_t simulated_ns(pcapng::Frame const& frame) const {
        auto const at = run_.lockstep ? std::string::npos : frame.comment.find(kSimulated);
        double time_s = 0;
        if (at != std::string::npos) {
            char const* const from = frame.comment.data() + at + kSimulated.size();
            if (std::from_chars(from, frame.comment.data() + frame.comment.size(), time_s).ec == std::errc{}) {
                return std::llround(time_s * 1e9);
            }
        }
        return frame.time_ns - run_.epoch_ns;
    }

    Result<void> take(pcapng::Frame const& frame, std::string const& interface) {
        auto const found = vantage_of(interface);
        if (!found) {
            return std::unexpected{found.error()};
        }
        Vantage& vantage = **found;
        std::uint64_t const number = ++vantage.done.frames;
        std::int64_t const time_ns = simulated_ns(frame);
        std::string const port = cell(wire::visible(interface));
        Captured const at{number, time_ns, frame.time_ns, interface,
                          fmt::format("{},{},{}", number, seconds_text(time_ns), port)};
        std::string protocol = "other", stream;
        FrameLabels::Label label;
        std::uint16_t const ethertype = iec61850::ethertype_of(frame.octets);
        if (ethertype == iec61850::kSvEthertype && iec61850::decode_sv(frame.octets, *sv_)) {
            protocol = "smv";
            label = take_samples(vantage, at, frame.octets, stream);
        } else if (ethertype == iec61850::kGooseEthertype && iec61850::decode_goose(frame.octets, goose_)) {
            protocol = "goose";
            label = take_message(vantage, at, frame.octets, stream);
        }
        vantage.frames.row("{},{},{},{},{}", at.prefix, protocol, cell(stream), label.altered() ? 1 : 0, label.attack);
        if (label.altered()) {
            ++vantage.done.altered;
            auto const [attack, is_new] = out_.attacks.try_emplace(std::string{label.attack});
            attack->second.first_ns = is_new ? time_ns : std::min(time_ns, attack->second.first_ns);
            attack->second.last_ns = is_new ? time_ns : std::max(time_ns, attack->second.last_ns);
            ++attack->second.altered_frames;
        }
        return copy(vantage, frame, interface, label);
    }

    FrameLabels::Label take_samples(Vantage& vantage, Captured const& at, iec61850::Octets octets,
                                    std::string& stream) {
        FrameLabels::Label out, whole;
        bool asked = false;
        for (iec61850::Asdu const& asdu : sv_->view()) {
            std::string const id = wire::visible(asdu.sv_id);
            auto const known = by_name_.find({true, id});
            stream = known == by_name_.end() ? id : known->second->name.name;
            if (known == by_name_.end() || (vantage.smv.size() >= kMostStreams && !vantage.smv.contains(id))) {
                continue; // nobody has described it: its frames are counted, and it has no features
            }
            if (!asked) { // a frame has one sender, whatever it carries
                asked = true;
                whole = labels_.of_frame(stream, at.interface, 1e-9 * static_cast<double>(at.time_ns), octets);
            }
            auto features = vantage.smv.find(id);
            if (features == vantage.smv.end()) {
                features = vantage.smv.emplace(id, SampleFeatures::of(*known->second, run_.frequency_hz)).first;
            }
            FrameLabels::Label const label =
                features->second.take(at, sv_->header, asdu, labels_, whole, vantage.samples);
            out = label.altered() ? label : out;
        }
        return out;
    }

    FrameLabels::Label take_message(Vantage& vantage, Captured const& at, iec61850::Octets octets,
                                    std::string& stream) {
        std::string const id = wire::visible(goose_.gocb_ref);
        auto const known = by_name_.find({false, id});
        stream = known == by_name_.end() ? id : known->second->name.name;
        FrameLabels::Label const label =
            labels_.of_message(stream, at.interface, 1e-9 * static_cast<double>(at.time_ns), octets);
        if (vantage.goose.size() < kMostStreams || vantage.goose.contains(id)) {
            vantage.goose.try_emplace(id, stream).first->second.take(at, goose_, label, vantage.messages);
        }
        return label;
    }

    Result<void> copy(Vantage& vantage, pcapng::Frame const& frame, std::string const& interface,
                      FrameLabels::Label const& label) {
        auto at = vantage.interfaces.find(frame.interface);
        if (at == vantage.interfaces.end()) {
            at = vantage.interfaces.emplace(frame.interface, vantage.capture.add_interface(interface)).first;
        }
        std::string comment = frame.comment;
        if (label.altered()) {
            comment += fmt::format("{}attack {}", comment.empty() ? "" : ", ", label.attack);
        }
        return vantage.capture.write(at->second, frame.time_ns, frame.octets, comment, frame.direction);
    }

    RunSource const& run_;
    fs::path folder_;
    FrameLabels labels_;
    std::map<std::pair<bool, std::string>, streams::Stream const*> by_name_; ///< by kind and name on the wire
    std::map<std::string, std::unique_ptr<Vantage>> vantages_;
    std::unique_ptr<iec61850::SvFrame> sv_{std::make_unique<iec61850::SvFrame>()};
    iec61850::GooseFrame goose_;
    ExportedRun out_;
};

} // namespace

Result<ExportedRun> export_run(RunSource const& run, fs::path const& folder,
                               std::function<void(std::uint64_t)> const& progress) {
    return Exporter{run, folder}.all(progress);
}

} // namespace gridspace::dataset
