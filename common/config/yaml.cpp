// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/yaml.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <sstream>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

namespace gridspace::config {
namespace {

constexpr std::size_t kLongestKey = 256; // YAML itself wants less than 1024 characters, after escapes

/// Builds Nodes from parse events; a stack of open containers.
class TreeBuilder final : public YAML::EventHandler {
  public:
    TreeBuilder(std::shared_ptr<SourceText const> source, Diagnostics& diagnostics)
        : source_{std::move(source)}, diagnostics_{diagnostics} {}

    void OnDocumentStart(YAML::Mark const& mark) override {
        if (++documents_ == 2) {
            diagnostics_.error(at(mark), "a second YAML document starts here; one file holds one document");
        }
    }
    void OnDocumentEnd() override {}
    void OnNull(YAML::Mark const& mark, YAML::anchor_t anchor) override {
        Node node;
        node.where = at(mark);
        add(std::move(node), anchor);
    }
    void OnAlias(YAML::Mark const& mark, YAML::anchor_t anchor) override {
        auto const it = anchors_.find(anchor);
        if (it == anchors_.end()) {
            diagnostics_.error(at(mark), "alias to an anchor that is not complete yet");
            OnNull(mark, 0);
            return;
        }
        add(copy(it->second), 0);
    }
    void OnScalar(YAML::Mark const& mark, std::string const& tag, YAML::anchor_t anchor,
                  std::string const& value) override {
        Node node = Node::scalar(value, at(mark));
        node.quoted = tag == "!";
        if (!node.quoted && (value == "~" || value == "null" || value.empty())) {
            node.kind = Node::Kind::null;
        }
        add(std::move(node), anchor);
    }
    void OnSequenceStart(YAML::Mark const& mark, std::string const&, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value) override {
        open(Node::sequence(at(mark)), anchor);
    }
    void OnSequenceEnd() override { close(); }
    void OnMapStart(YAML::Mark const& mark, std::string const&, YAML::anchor_t anchor,
                    YAML::EmitterStyle::value) override {
        open(Node::map(at(mark)), anchor);
    }
    void OnMapEnd() override { close(); }

    [[nodiscard]] int documents() const { return documents_; }
    [[nodiscard]] Node take() { return std::move(root_); }

  private:
    struct Open {
        Node node;
        YAML::anchor_t anchor;
        bool has_key{false};
        std::string key;
        SourceMark key_mark;
        std::map<std::string, std::size_t> keys; ///< of a map, each with its place: no search from the first key on
    };

    SourceMark at(YAML::Mark const& mark) const {
        return {source_, mark.line + 1, mark.column + 1}; // yaml-cpp counts from 0
    }

    /// Each value under an anchor is kept once more, and each alias is a copy of what it stands for.
    Node copy(Node const& node) {
        count(node); // before the copy is made
        return node;
    }

    void count(Node const& node) {
        if (++copies_ > kMaxYamlCopies) {
            throw YAML::ParserException(
                {}, fmt::format("anchors and aliases stand for more than {} values", kMaxYamlCopies));
        }
        for (Node const& item : node.items) {
            count(item);
        }
        for (Node::Entry const& entry : node.entries) {
            count(entry.value);
        }
    }

    void open(Node node, YAML::anchor_t anchor) {
        if (stack_.size() >= kMaxYamlDepth) {
            throw YAML::ParserException({}, fmt::format("nested deeper than {} levels", kMaxYamlDepth));
        }
        stack_.push_back({std::move(node), anchor, false, {}, {}, {}});
    }

    void close() {
        Open done = std::move(stack_.back());
        stack_.pop_back();
        add(std::move(done.node), done.anchor);
    }

    void add(Node node, YAML::anchor_t anchor) {
        if (++nodes_ > kMaxYamlValues) {
            throw YAML::ParserException({}, fmt::format("more than {} values", kMaxYamlValues));
        }
        if (anchor != 0) {
            anchors_[anchor] = copy(node);
        }
        if (stack_.empty()) {
            if (documents_ == 1) {
                root_ = std::move(node);
            }
            return;
        }
        Open& parent = stack_.back();
        if (parent.node.is_sequence()) {
            parent.node.items.push_back(std::move(node));
        } else if (!parent.has_key) {
            take_key(parent, node);
        } else {
            parent.has_key = false;
            auto const [place, fresh] = parent.keys.try_emplace(parent.key, parent.node.entries.size());
            if (fresh) {
                parent.node.entries.push_back({parent.key, parent.key_mark, std::move(node)});
            } else {
                diagnostics_.error(parent.key_mark, fmt::format("duplicate key '{}'", parent.key),
                                   "first given at " + parent.node.entries[place->second].where.to_string(),
                                   static_cast<int>(parent.key.size()));
            }
        }
    }

    void take_key(Open& parent, Node const& key) {
        parent.has_key = true;
        parent.key = key.text;
        parent.key_mark = key.where;
        if (key.text.size() > kLongestKey) {
            diagnostics_.error(key.where, fmt::format("a key of {} characters", key.text.size()),
                               "a quote or a bracket that is not closed?");
        }
        if (!key.is_scalar()) {
            diagnostics_.error(key.where, fmt::format("a key must be a name, found {}", describe(key)));
        }
    }

    std::shared_ptr<SourceText const> source_;
    Diagnostics& diagnostics_;
    Node root_;
    std::vector<Open> stack_;
    std::map<YAML::anchor_t, Node> anchors_;
    int documents_{0};
    std::size_t nodes_{0}, copies_{0};
};

} // namespace

std::shared_ptr<SourceText const> make_source(std::string name, std::string_view text, std::string directory) {
    auto source = std::make_shared<SourceText>();
    source->name = std::move(name);
    source->directory = std::move(directory);
    source->lines.reserve(static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')) + 1);
    for (std::size_t begin = 0; begin <= text.size();) {
        std::size_t const end = std::min(text.find('\n', begin), text.size());
        std::string_view const line = text.substr(begin, end - begin);
        source->lines.emplace_back(line.ends_with('\r') ? line.substr(0, line.size() - 1) : line);
        begin = end + 1;
    }
    return source;
}

namespace {

/// What usually lies behind a message of the YAML parser.
std::string yaml_hint(SourceText const& source, SourceMark const& where, std::string const& message) {
    for (int line = where.line; line >= std::max(1, where.line - 1);
         --line) { // it notices a tab on the next line, sometimes
        if (static_cast<std::size_t>(line) <= source.lines.size()) {
            std::string const& text = source.lines[static_cast<std::size_t>(line) - 1];
            if (text.find_first_not_of(" \t") > text.find('\t')) {
                return fmt::format("line {} is indented with a tab; YAML wants spaces", line);
            }
        }
    }
    if (message.find("end of sequence flow") != std::string::npos ||
        message.find("end of map flow") != std::string::npos) {
        std::size_t const line = static_cast<std::size_t>(std::max(1, where.line)) - 1;
        if (line < source.lines.size() && source.lines[line].find(" in [") != std::string::npos) {
            return "an expression with '[' or ',' in it is a text: put it in quotes";
        }
        return message.find("map") != std::string::npos ? "a '}' or a ',' is missing here or before"
                                                        : "a ']' or a ',' is missing here or before";
    }
    if (message.find("end of map not found") != std::string::npos ||
        message.find("illegal map value") != std::string::npos) {
        return "a key at another depth than its neighbours, or a ': ' inside a text without quotes?";
    }
    return "";
}

/// What yaml-cpp would take much memory for before it says anything of it: it reads to the end of a line before it
/// knows what a bracket begins. Quotes are not looked at: no text holds a thousand brackets that are not closed.
std::string too_many_brackets(std::string_view text) {
    constexpr std::size_t kOpen = 1000 + kMaxYamlDepth, kInALine = 400'000;
    std::size_t open = 0, in_line = 0, line = 1;
    for (char const c : text) {
        bool const opens = c == '[' || c == '{', closes = c == ']' || c == '}';
        open = opens ? open + 1 : closes && open > 0 ? open - 1 : open;
        in_line = c == '\n' ? 0 : in_line + (opens || closes || c == ',' ? 1 : 0);
        line += c == '\n' ? 1 : 0;
        if (open > kOpen) {
            return fmt::format("nested deeper than {} levels", kMaxYamlDepth);
        }
        if (in_line > kInALine) {
            return fmt::format("line {} has more than {} brackets and commas", line, kInALine);
        }
    }
    return "";
}

} // namespace

std::optional<Node> parse_yaml(std::string_view text, std::shared_ptr<SourceText const> source,
                               Diagnostics& diagnostics) {
    if (std::string const many = too_many_brackets(text); !many.empty()) {
        diagnostics.error({source, 0, 0}, "not valid YAML: " + many);
        return std::nullopt;
    }
    std::istringstream stream{std::string{text}};
    TreeBuilder builder{source, diagnostics};
    try {
        YAML::Parser parser{stream};
        while (builder.documents() < 2 && parser.HandleNextDocument(builder)) {
        }
    } catch (YAML::Exception const& e) {
        SourceMark where{source, 0, 0};
        if (!e.mark.is_null() && e.mark.line >= 0) {
            where = {source, e.mark.line + 1, e.mark.column + 1};
        }
        diagnostics.error(where, fmt::format("not valid YAML: {}", e.msg), yaml_hint(*source, where, e.msg));
        return std::nullopt;
    }
    Node root = builder.take();
    if (root.where.source == nullptr) { // an empty text
        root.where = {source, 0, 0};
    }
    return root;
}

std::optional<Node> load_yaml(std::filesystem::path const& file, Diagnostics& diagnostics, SourceMark named_at) {
    std::error_code ignored;
    std::ifstream stream{file, std::ios::binary};
    if (std::filesystem::is_directory(file, ignored) || !stream) {
        if (named_at.source == nullptr) {
            named_at.source = make_source(file.string(), "");
        }
        diagnostics.error(named_at, fmt::format("cannot read the file '{}'", file.string()),
                          std::filesystem::exists(file, ignored) ? "it is not a readable file" : "no such file");
        return std::nullopt;
    }
    std::string text;
    for (char part[65536]; text.size() <= kMaxYamlOctets && (stream.read(part, sizeof part), stream.gcount() > 0);) {
        text.append(part, static_cast<std::size_t>(stream.gcount()));
    }
    std::filesystem::path const parent = file.parent_path();
    std::string const directory = parent.empty() ? "." : parent.string();
    if (text.size() > kMaxYamlOctets) {
        diagnostics.error({make_source(file.string(), "", directory), 0, 0},
                          fmt::format("the file has more than {} octets", kMaxYamlOctets),
                          "no configuration is that long: is it another file?");
        return std::nullopt;
    }
    auto source = make_source(file.string(), text, directory);
    return parse_yaml(text, source, diagnostics);
}

} // namespace gridspace::config
