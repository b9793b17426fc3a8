// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/opendss_file.hpp"

#include "common/config/yaml.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <iterator>

namespace gridspace::opendss {
namespace {

namespace fs = std::filesystem;

/// The file of a path whose names may be in another case, as scripts from Windows have them.
fs::path in_any_case(fs::path const& path) {
    std::error_code ignored;
    fs::path out;
    for (fs::path const& part : path) {
        fs::path const exact = out / part;
        if (out.empty() || fs::exists(exact, ignored)) {
            out = exact;
            continue;
        }
        fs::path found = exact;
        for (auto const& entry : fs::directory_iterator{out, ignored}) {
            if (lower(entry.path().filename().string()) == lower(part.string())) {
                found = entry.path();
                break;
            }
        }
        out = found;
    }
    return out;
}

bool lies_in(fs::path const& file, fs::path const& folder) {
    auto const [end, rest] = std::mismatch(folder.begin(), folder.end(), file.begin(), file.end());
    return end == folder.end();
}

/// A script or a table in the folder above, which the published feeders share ("Redirect ../IEEELineCodes.DSS"). Not
/// deeper, and nothing else: what a stranger's script may show in an error is bounded.
bool is_shared_script(fs::path const& file, fs::path const& folder) {
    std::string const kind = lower(file.extension().string());
    return file.parent_path() == folder.parent_path() && (kind == ".dss" || kind == ".csv" || kind == ".txt");
}

Result<DssFile> read_file(fs::path const& file, fs::path const& shown) {
    std::error_code failed;
    auto const size = fs::file_size(file, failed);
    if (failed || !fs::is_regular_file(file, failed)) {
        return fail(ExitCode::usage, fmt::format("there is no file '{}'", shown.string()));
    }
    if (size > kMaxOctets) {
        return fail(ExitCode::usage, fmt::format("'{}' has more than {} MiB", shown.string(), kMaxOctets >> 20U));
    }
    std::ifstream in{file, std::ios::binary};
    DssFile out{{std::istreambuf_iterator<char>{in}, {}}, shown.string(), file.parent_path().string()};
    if (!in) {
        return fail(ExitCode::usage, fmt::format("'{}' cannot be read", shown.string()));
    }
    return out;
}

} // namespace

bool is_script(fs::path const& file) {
    return lower(file.extension().string()) == ".dss";
}

std::optional<Circuit> load_circuit(fs::path const& file, ScriptOptions const& options,
                                    config::Diagnostics& diagnostics) {
    std::error_code ignored;
    auto main = read_file(fs::weakly_canonical(file, ignored), file);
    if (!main) {
        diagnostics.error({config::make_source(file.string(), ""), 0, 0}, main.error().message, main.error().remedy);
        return std::nullopt;
    }
    std::vector<fs::path> roots{main->folder};
    for (fs::path const& folder : options.folders) {
        roots.push_back(fs::weakly_canonical(folder, ignored));
    }
    auto const read = [&](std::string const& folder, std::string const& path) -> Result<DssFile> {
        std::error_code failed;
        fs::path const whole = fs::weakly_canonical(in_any_case((fs::path{folder} / path).lexically_normal()), failed);
        bool const allowed =
            std::any_of(roots.begin(), roots.end(), [&](fs::path const& root) { return lies_in(whole, root); });
        if (!allowed && !is_shared_script(whole, roots.front())) {
            return fail(ExitCode::usage,
                        fmt::format("'{}' lies outside the script's folder, and is no script beside that folder", path),
                        "name its folder with --include");
        }
        fs::path const relative = whole.lexically_relative(roots.front());
        return read_file(whole, relative.empty() ? whole : file.parent_path() / relative);
    };
    Script const script = run_script(*main, read, diagnostics, options.commands);
    auto circuit = build_circuit(script, diagnostics, options.hour);
    if (circuit && script.solves > 0 && script.changed_since_solve) {
        circuit->left_out.push_back(
            {{}, "the state at the last `solve`: what the script changes after it is shown", true});
    }
    return circuit;
}

} // namespace gridspace::opendss
