// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/forecaster/model_file.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <openssl/evp.h>
#include <set>

namespace gridspace::ids {
namespace {

using Json = nlohmann::ordered_json;
constexpr std::uintmax_t kMaxBytes = 64U << 20U;

char const* word(Model::Scale s) {
    return s == Model::Scale::fixed ? "fixed" : "window_peak";
}
char const* word(Layer::Activation a) {
    return a == Layer::Activation::tanh ? "tanh" : "linear";
}

void append(std::string& bytes, std::vector<double> const& values) {
    for (double const v : values) {
        auto const bits = std::bit_cast<std::uint64_t>(v);
        for (unsigned k = 0; k < 8; ++k) {
            bytes += static_cast<char>((bits >> (8 * k)) & 0xFFU);
        }
    }
}

/// Reads the members of one JSON object strictly; the first mistake is kept.
class Reader {
  public:
    Reader(Json const& object, std::string path, std::string& error)
        : object_{object}, path_{std::move(path)}, error_{error} {
        if (!object.is_object()) {
            complain("", "an object expected");
        }
    }
    Json const* find(char const* key) {
        known_.insert(key);
        if (!object_.is_object() || !object_.contains(key)) {
            complain(key, "it is missing");
            return nullptr;
        }
        return &object_.at(key);
    }
    void number(char const* key, double& out) {
        Json const* v = find(key);
        if (v != nullptr && !v->is_number()) {
            complain(key, fmt::format("a number expected, {} found", v->type_name()));
        } else if (v != nullptr) {
            out = v->get<double>();
        }
    }
    void integer(char const* key, int& out) {
        Json const* v = find(key);
        if (v == nullptr) {
            return;
        }
        if (!v->is_number_integer() || v->get<double>() < 0 || v->get<double>() > 1e6) {
            complain(key, "a whole number from 0 to 1000000 expected");
            return;
        }
        out = v->get<int>();
    }
    void text(char const* key, std::string& out) {
        Json const* v = find(key);
        if (v != nullptr && !v->is_string()) {
            complain(key, fmt::format("text expected, {} found", v->type_name()));
        } else if (v != nullptr) {
            out = v->get<std::string>();
        }
    }
    template <class E>
    void choice(char const* key, E& out, std::initializer_list<std::pair<char const*, E>> words) {
        std::string given;
        text(key, given);
        for (auto const& [name, meaning] : words) {
            if (given == name) {
                out = meaning;
                return;
            }
        }
        complain(key, fmt::format("'{}' is not known", given));
    }
    void numbers(char const* key, std::vector<double>& out) {
        Json const* v = find(key);
        if (v == nullptr) {
            return;
        }
        if (!v->is_array()) {
            complain(key, "a list of numbers expected");
            return;
        }
        for (std::size_t i = 0; i < v->size(); ++i) {
            if (!(*v)[i].is_number()) {
                complain(key, fmt::format("item {} is not a number", i + 1));
                return;
            }
            out.push_back((*v)[i].get<double>());
        }
    }
    void finish() {
        if (object_.is_object()) {
            for (auto const& [key, value] : object_.items()) {
                if (!known_.contains(key)) {
                    complain(key.c_str(), "unknown field");
                }
            }
        }
    }
    void complain(char const* key, std::string const& what) {
        if (error_.empty()) {
            error_ = fmt::format("{}{}{}: {}", path_, *key != 0 && !path_.empty() ? "." : "", key, what);
        }
    }

  private:
    Json const& object_;
    std::string path_;
    std::string& error_;
    std::set<std::string> known_;
};

std::vector<Layer> read_layers(Json const& layers, std::string& error) {
    std::vector<Layer> out;
    for (std::size_t k = 0; k < layers.size(); ++k) {
        Layer layer;
        Reader l{layers[k], fmt::format("layers[{}]", k), error};
        l.integer("inputs", layer.inputs);
        l.integer("outputs", layer.outputs);
        l.choice<Layer::Activation>("activation", layer.activation,
                                    {{"linear", Layer::Activation::linear}, {"tanh", Layer::Activation::tanh}});
        l.numbers("weights", layer.weights);
        l.numbers("bias", layer.bias);
        l.finish();
        out.push_back(std::move(layer));
    }
    return out;
}

} // namespace

std::string model_hash(Model const& m) {
    std::string bytes =
        fmt::format("window={}\nchannels={}\nrate_hz={:.17g}\nfrequency_hz={:.17g}\nscale={}\nscale_a={:.17g}\n",
                    m.window, m.channels, m.rate_hz, m.frequency_hz, word(m.scale), m.scale_a);
    for (Layer const& layer : m.layers) {
        bytes += fmt::format("layer={}x{} {}\n", layer.outputs, layer.inputs, word(layer.activation));
        append(bytes, layer.weights);
        append(bytes, layer.bias);
    }
    std::array<unsigned char, 32> digest{};
    unsigned int length = 0;
    EVP_Digest(bytes.data(), bytes.size(), digest.data(), &length, EVP_sha256(), nullptr);
    std::string out;
    for (unsigned char const byte : digest) {
        out += fmt::format("{:02x}", byte);
    }
    return out;
}

std::string to_json(Model const& m) {
    Json layers = Json::array();
    for (Layer const& layer : m.layers) {
        layers.push_back({{"inputs", layer.inputs},
                          {"outputs", layer.outputs},
                          {"activation", word(layer.activation)},
                          {"weights", layer.weights},
                          {"bias", layer.bias}});
    }
    Json provenance = Json::object();
    for (auto const& [key, value] : m.provenance) {
        provenance[key] = value;
    }
    Json const out{{"gridspace_forecaster", 1},
                   {"name", m.name},
                   {"kind", m.kind},
                   {"window", m.window},
                   {"channels", m.channels},
                   {"rate_hz", m.rate_hz},
                   {"frequency_hz", m.frequency_hz},
                   {"scale", word(m.scale)},
                   {"scale_a", m.scale_a},
                   {"sha256", model_hash(m)},
                   {"provenance", provenance},
                   {"layers", layers}};
    return out.dump(1) + "\n";
}

Result<Model> model_from_json(std::string_view text, std::string const& source) {
    auto const bad = [&](std::string const& what,
                         std::string remedy = "train it again with `gridspace ids train`, or restore the file") {
        return fail(ExitCode::usage, fmt::format("{}: {}", source, what), std::move(remedy));
    };
    Json json;
    try {
        json = Json::parse(text);
    } catch (Json::parse_error const& e) {
        return bad(fmt::format("not readable as JSON, near byte {} of {}", e.byte, text.size()));
    } catch (Json::exception const& e) { // e.g. a number beyond a double
        return bad(e.what());
    }
    if (!json.is_object() || !json.contains("gridspace_forecaster")) {
        return bad("not a forecaster of Gridspace (the field 'gridspace_forecaster' is missing)");
    }
    if (json["gridspace_forecaster"] != 1) {
        return bad(
            fmt::format("version {} of the format; this program reads version 1", json["gridspace_forecaster"].dump()),
            "use a newer Gridspace");
    }
    Model m;
    std::string error, hash;
    Reader r{json, "", error};
    static_cast<void>(r.find("gridspace_forecaster"));
    r.text("name", m.name);
    r.text("kind", m.kind);
    r.integer("window", m.window);
    r.integer("channels", m.channels);
    r.number("rate_hz", m.rate_hz);
    r.number("frequency_hz", m.frequency_hz);
    r.choice<Model::Scale>("scale", m.scale,
                           {{"fixed", Model::Scale::fixed}, {"window_peak", Model::Scale::window_peak}});
    r.number("scale_a", m.scale_a);
    r.text("sha256", hash);
    if (Json const* provenance = r.find("provenance"); provenance != nullptr && provenance->is_object()) {
        for (auto const& [key, value] : provenance->items()) {
            m.provenance.emplace_back(key, value.is_string() ? value.get<std::string>() : value.dump());
        }
    }
    if (Json const* layers = r.find("layers"); layers != nullptr && layers->is_array()) {
        m.layers = read_layers(*layers, error);
    } else if (layers != nullptr) {
        r.complain("layers", "a list expected");
    }
    r.finish();
    if (!error.empty()) {
        return bad(error);
    }
    if (auto const ok = check(m); !ok) {
        return bad(ok.error().message);
    }
    if (std::string const actual = model_hash(m); actual != hash) {
        return bad(fmt::format("its contents have the hash {}…, and the field sha256 says '{}…': somebody changed it",
                               actual.substr(0, 12), hash.substr(0, 12)));
    }
    return m;
}

Result<Model> load_model(std::filesystem::path const& file) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(file, error)) {
        return fail(ExitCode::usage, fmt::format("{}: no such file", file.string()),
                    "name a model file, e.g. configs/models/ar_20.json");
    }
    if (std::filesystem::file_size(file, error) > kMaxBytes) {
        return fail(ExitCode::usage, fmt::format("{}: larger than 64 MB; not a model", file.string()));
    }
    std::ifstream stream{file, std::ios::binary};
    std::string const text{std::istreambuf_iterator<char>{stream}, {}};
    if (!stream && !stream.eof()) {
        return fail(ExitCode::environment, fmt::format("{}: cannot be read", file.string()));
    }
    return model_from_json(text, file.string());
}

Result<void> save_model(Model const& model, std::filesystem::path const& file) {
    std::filesystem::path const temporary = file.string() + ".part"; // a full disk must not leave half a model behind
    {
        std::ofstream stream{temporary, std::ios::binary | std::ios::trunc};
        stream << to_json(model);
        stream.flush();
        if (!stream) {
            return fail(ExitCode::environment, fmt::format("{}: cannot be written", file.string()),
                        "check the folder and the free space");
        }
    }
    std::error_code error;
    std::filesystem::rename(temporary, file, error);
    if (error) {
        return fail(ExitCode::environment, fmt::format("{}: {}", file.string(), error.message()));
    }
    return {};
}

} // namespace gridspace::ids
