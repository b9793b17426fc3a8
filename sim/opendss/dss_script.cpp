// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/dss_script.hpp"

#include "common/config/yaml.hpp"
#include "common/text.hpp"
#include "sim/opendss/dss_commands.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fmt/format.h>

namespace gridspace::opendss {
namespace {

using config::SourceMark;

/// Whether a property names a bus, which `like` does not copy.
bool names_bus(ClassInfo const& info, std::size_t property) {
    std::string_view const name = info.properties[property];
    return info.name != "regcontrol" && (name == "bus1" || name == "bus2" || name == "bus" || name == "buses");
}

class Interpreter {
  public:
    Interpreter(ReadDssFile const& read, config::Diagnostics& diagnostics) : read_{read}, diagnostics_{diagnostics} {}

    void run(DssFile const& file) {
        octets_ += file.text.size();
        if (octets_ > kMaxOctets) {
            diagnostics_.error(here_, fmt::format("the files are more than {} MiB together", kMaxOctets >> 20U));
            stopped_ = true;
            return;
        }
        stack_.push_back(file.folder + '/' + file.name);
        folder_ = file.folder;
        auto const source = config::make_source(file.name, file.text, file.folder);
        bool in_comment = false;
        for (std::size_t i = 0; i < source->lines.size() && !stopped_ && !diagnostics_.full(); ++i) {
            std::string const& line = source->lines[i];
            std::string_view const content = trim(line);
            in_comment = in_comment || content.starts_with("/*");
            if (!in_comment) {
                command(line, {source, static_cast<int>(i) + 1, 1});
            }
            in_comment = in_comment && content.find("*/") == std::string_view::npos;
        }
        stack_.pop_back();
    }

    Script take() { return std::move(script_); }

  private:
    struct Command {
        std::string name;
        void (Interpreter::*run)(std::vector<Word>&);
    };
    static std::vector<Command> const& commands();

    void command(std::string_view line, SourceMark const& start) {
        std::vector<Word> words = words_of(line, start, diagnostics_);
        for (Word& word : words) {
            insert_variables(word);
        }
        if (words.empty()) {
            return;
        }
        here_ = words.front().where;
        if (!words.front().name.empty()) { // Transformer.reg1.tap=1.05
            assign_directly(words);
            return;
        }
        std::string const name = lower(words.front().value);
        words.erase(words.begin());
        auto const& all = commands();
        auto it = std::find_if(all.begin(), all.end(), [&](Command const& c) { return c.name == name; });
        if (it == all.end()) {
            it = std::find_if(all.begin(), all.end(), [&](Command const& c) { return c.name.starts_with(name); });
        }
        if (it == all.end()) {
            std::vector<std::string> names;
            std::transform(all.begin(), all.end(), std::back_inserter(names),
                           [](Command const& c) { return std::string{c.name}; });
            error(here_, fmt::format("there is no command '{}'", name), did_you_mean(name, names));
            return;
        }
        command_ = it->name;
        (this->*it->run)(words);
    }

    void error(SourceMark const& where, std::string message, std::string hint = {}) {
        diagnostics_.error(where, std::move(message), std::move(hint));
    }

    // ---- variables ----
    void insert_variables(Word& word) {
        std::size_t at = word.value.find('@');
        while (at != std::string::npos && !variables_.empty()) {
            std::size_t end = at + 1;
            while (end < word.value.size() &&
                   (std::isalnum(static_cast<unsigned char>(word.value[end])) != 0 || word.value[end] == '_')) {
                ++end;
            }
            auto const it = variables_.find(lower(word.value.substr(at, end - at)));
            if (it != variables_.end()) {
                word.enclosed = word.enclosed || it->second.enclosed;
                word.value.replace(at, end - at, it->second.value);
                end = at + it->second.value.size();
            }
            at = word.value.find('@', end);
        }
    }
    void define_variables(std::vector<Word>& words) {
        for (Word& word : words) {
            if (!word.name.starts_with('@') || word.value.size() > 255) {
                error(word.where, "a variable is @name=value, of at most 255 characters");
                return;
            }
            variables_[word.name] = word;
        }
    }

    // ---- objects ----
    /// "class.name", or the name alone for an object of the class that was used last.
    std::pair<std::string, std::string> split_name(std::string const& text) {
        std::string const all = lower(text);
        std::size_t const dot = all.find('.');
        if (dot == std::string::npos) {
            return {last_class_, all};
        }
        return {all.substr(0, dot), all.substr(dot + 1)};
    }

    void make(std::vector<Word>& words) {
        if (words.empty()) {
            error(here_, "'new' needs an object", "expected new Class.Name property=value …");
            return;
        }
        auto [class_name, name] = split_name(words.front().value);
        SourceMark const where = words.front().where;
        words.erase(words.begin());
        if (class_name == "circuit") {
            begin_circuit(name, where);
            class_name = "vsource";
            name = "source";
            Word bus{"bus1", "sourcebus", false, where};
            words.insert(words.begin(), bus);
        }
        ClassInfo const* info = find_class(class_name);
        if (info == nullptr) {
            std::vector<std::string> names;
            for (std::string_view const n : class_names()) {
                names.emplace_back(n);
            }
            error(where, fmt::format("there is no class '{}'", class_name),
                  did_you_mean(class_name, names, "expected new Class.Name"));
            active_ = nullptr;
            return;
        }
        last_class_ = class_name;
        active_ = nullptr;
        if (info->treatment != Treatment::modelled) {
            script_.left_out.push_back(
                {where, fmt::format("{}.{}", class_name, name), info->treatment == Treatment::left_out});
            ignoring_ = true;
            return;
        }
        static constexpr std::string_view kOfNoCircuit[] = {"linecode",  "linegeometry", "linespacing",
                                                            "loadshape", "wiredata",     "xfmrcode"};
        bool const data =
            std::find(std::begin(kOfNoCircuit), std::end(kOfNoCircuit), class_name) != std::end(kOfNoCircuit);
        if (script_.circuit.empty() && !data) {
            error(where, fmt::format("{}.{} comes before any circuit", class_name, name),
                  "expected `New Circuit.Name` first");
            return;
        }
        activate(*info, name, where);
        edit_active(words);
    }

    void activate(ClassInfo const& info, std::string const& name, SourceMark const& where) {
        ignoring_ = false;
        auto const [it, fresh] =
            script_.index.try_emplace(fmt::format("{}.{}", info.name, name), script_.objects.size());
        if (fresh) {
            if (script_.objects.size() >= kMaxObjects) {
                error(where, fmt::format("there are more than {} objects", kMaxObjects));
                stopped_ = true;
                script_.index.erase(it);
                return;
            }
            script_.objects.push_back({&info, name, where, {}, {}});
        } else if (info.name != "vsource") {
            diagnostics_.warning(where, fmt::format("{}.{} was made before: this changes it", info.name, name));
        }
        active_ = &script_.objects[it->second];
    }

    void begin_circuit(std::string const& name, SourceMark const& where) {
        if (!script_.circuit.empty()) {
            error(where, fmt::format("there is a circuit already, '{}'", script_.circuit),
                  "one circuit at a time; `Clear` begins anew");
        }
        script_.circuit = name.empty() ? "circuit" : name;
    }

    Object* existing(std::string const& text, SourceMark const& where) {
        auto const [class_name, name] = split_name(text);
        auto const it = script_.index.find(class_name + '.' + name);
        if (it == script_.index.end()) {
            std::vector<std::string> names;
            for (auto const& [full, position] : script_.index) {
                names.push_back(full);
            }
            ClassInfo const* info = find_class(class_name);
            ignoring_ = info != nullptr && info->treatment != Treatment::modelled;
            if (!ignoring_) {
                error(where, fmt::format("there is no {}.{}", class_name, name),
                      names.size() > 5000 ? std::string{} : did_you_mean(class_name + '.' + name, names));
            }
            return nullptr;
        }
        last_class_ = class_name;
        ignoring_ = false;
        return &script_.objects[it->second];
    }

    void edit(std::vector<Word>& words) {
        if (words.empty()) {
            error(here_, "'edit' needs an object", "expected edit Class.Name property=value …");
            return;
        }
        active_ = existing(words.front().value, words.front().where);
        words.erase(words.begin());
        edit_active(words);
    }
    void more(std::vector<Word>& words) {
        if (active_ == nullptr && !ignoring_ && diagnostics_.ok()) {
            error(here_, "nothing to continue: no object was made or edited before");
        }
        edit_active(words);
    }

    void assign_directly(std::vector<Word>& words) {
        std::string const path = words.front().name;
        std::size_t const dot = path.rfind('.');
        if (dot == std::string::npos) {
            error(here_, fmt::format("there is no command '{}'", path), "expected Class.Name.property=value");
            return;
        }
        active_ = existing(path.substr(0, dot), here_);
        words.front().name = path.substr(dot + 1);
        edit_active(words);
    }

    void edit_active(std::vector<Word>& words) {
        script_.changed_since_solve = true;
        if (active_ != nullptr) {
            assign(*active_, words);
        }
    }

    void assign(Object& object, std::vector<Word> const& words) {
        ClassInfo const& info = *object.info;
        std::size_t next = 0;
        bool begins = true;
        for (Word const& word : words) {
            if (!word.name.empty()) {
                auto const property = find_property(info, word.name);
                if (!property) {
                    std::vector<std::string> const names{info.properties.begin(), info.properties.end()};
                    error(word.where, fmt::format("a {} has no property '{}'", info.name, word.name),
                          did_you_mean(word.name, names));
                    continue;
                }
                next = *property;
            }
            if (next >= info.properties.size()) {
                error(word.where,
                      fmt::format("a {} has no more properties than {}", info.name, info.properties.size()));
                return;
            }
            if (info.properties[next] == "like") {
                copy(object, word);
            } else if (!count_values(1, word.where)) {
                return;
            } else {
                object.assignments.push_back({next, word, begins});
                begins = false;
            }
            ++next;
        }
    }

    bool count_values(std::size_t more, SourceMark const& where) {
        values_ += more;
        if (values_ > kMaxAssignments && !stopped_) {
            error(where, fmt::format("the objects have more than {} values", kMaxAssignments));
            stopped_ = true;
        }
        return !stopped_;
    }

    /// `like`: everything of another object of the class but its buses replaces what was given before.
    void copy(Object& object, Word const& word) {
        Object const* other = script_.find(object.info->name, lower(word.value));
        if (other == nullptr || other == &object) {
            error(word.where, fmt::format("there is no other {} '{}' to be like", object.info->name, word.value));
            return;
        }
        if (!count_values(other->assignments.size(), word.where)) {
            return;
        }
        std::erase_if(object.assignments, [&](Assignment const& a) { return !names_bus(*object.info, a.property); });
        for (Assignment const& a : other->assignments) {
            if (!names_bus(*object.info, a.property)) {
                object.assignments.push_back(a);
            }
        }
    }

    void batch_edit(std::vector<Word>& words) {
        if (words.empty()) {
            error(here_, "'batchedit' needs objects", "expected batchedit Class.pattern property=value …");
            return;
        }
        auto const [class_name, expression] = split_name(words.front().value);
        SourceMark const where = words.front().where;
        words.erase(words.begin());
        // Of regular expressions: '.', and '.*' for any run of characters, at both ends unless '^' or '$' say
        // otherwise.
        std::string pattern;
        bool const from_start = expression.starts_with('^'), to_end = expression.ends_with('$');
        std::string const body = expression.substr(from_start ? 1 : 0, expression.size() - (from_start ? 1 : 0) -
                                                                           (to_end && expression.size() > 1 ? 1 : 0));
        for (std::size_t i = 0; i < body.size(); ++i) {
            bool const any = body[i] == '.';
            bool const run = any && i + 1 < body.size() && body[i + 1] == '*';
            if (!any && std::string_view{"*+?()[]{}|\\^$"}.find(body[i]) != std::string_view::npos) {
                error(where, fmt::format("'{}' is more than this knows of regular expressions", expression),
                      "expected letters, '.', '.*', '^' and '$'");
                return;
            }
            pattern += run ? '*' : any ? '?' : body[i];
            i += run ? 1 : 0;
        }
        pattern = (from_start ? "" : "*") + pattern + (to_end ? "" : "*");
        script_.changed_since_solve = true;
        for (Object& object : script_.objects) {
            if (object.info->name == class_name && matches_glob(pattern, object.name) && !stopped_) {
                assign(object, words);
            }
        }
    }

    void enable(std::vector<Word>& words) { set_enabled(words, "yes"); }
    void disable(std::vector<Word>& words) { set_enabled(words, "no"); }
    void set_enabled(std::vector<Word>& words, char const* value) {
        if (Object* object = words.empty() ? nullptr : existing(words.front().value, words.front().where)) {
            script_.changed_since_solve = true;
            assign(*object, {Word{"enabled", value, false, here_}});
        }
    }

    void open(std::vector<Word>& words) { switch_terminal(words, true); }
    void close(std::vector<Word>& words) { switch_terminal(words, false); }
    void switch_terminal(std::vector<Word>& words, bool opens) {
        Object* object = words.empty() ? nullptr : existing(words.front().value, words.front().where);
        if (object == nullptr) {
            return;
        }
        int number[2] = {1, 0};
        for (std::size_t i = 0; i < 2 && i + 1 < words.size(); ++i) {
            std::string const& text = words[i + 1].value;
            bool const digits = !text.empty() && text.size() < 4 &&
                                std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
            if (!digits) {
                error(words[i + 1].where, fmt::format("'{}' is not a terminal or conductor", text),
                      "expected a number");
                return;
            }
            number[i] = std::stoi(text);
        }
        script_.changed_since_solve = true;
        std::pair const key{number[0], number[1]};
        if (opens) {
            object->open.insert(key);
        } else if (number[1] == 0) {
            std::erase_if(object->open, [&](auto const& o) { return o.first == number[0]; });
        } else {
            object->open.erase(key);
        }
    }

    // ---- files ----
    void redirect(std::vector<Word>& words) {
        std::string const folder = folder_;
        include(words);
        folder_ = folder;
    }
    void compile(std::vector<Word>& words) { include(words); } // stays in the folder of the file
    void include(std::vector<Word>& words) {
        if (words.empty()) {
            error(here_, "a file is missing", "expected redirect FILE");
            return;
        }
        Word const word = words.front();
        std::string path = word.value;
        std::replace(path.begin(), path.end(), '\\', '/');
        auto const file = read_(folder_, path);
        if (!file) {
            error(word.where, file.error().message, file.error().remedy);
            return;
        }
        if (std::find(stack_.begin(), stack_.end(), file->folder + '/' + file->name) != stack_.end()) {
            error(word.where, fmt::format("'{}' is being read already: the files redirect in a circle", file->name));
            return;
        }
        if (stack_.size() >= static_cast<std::size_t>(kMaxDepth)) {
            error(word.where, fmt::format("files redirect more than {} deep", kMaxDepth));
            return;
        }
        run(*file);
    }

    // ---- options ----
    /// The option that this is the beginning of; OpenDSS takes beginnings of names, too, and the first of its list.
    /// Among those that are read stand others that come before one of them there.
    static std::string whole_option(std::string const& name) {
        static constexpr std::array<std::string_view, 12> kInOrder{
            "mode",     "frequency",     "basefrequency",  "defaultdaily", "defaultbasefrequency", "loadmodel",
            "loadmult", "maxiterations", "maxcontroliter", "controlmode",  "voltagebases",         "earthmodel"};
        auto const begins = [&](std::string_view option) { return option.starts_with(name); };
        auto const found = std::ranges::find_if(kInOrder, begins);
        return name.size() > 2 && found != kInOrder.end() ? std::string{*found} : name;
    }
    void set(std::vector<Word>& words) {
        for (Word& word : words) {
            if (word.name.empty()) {
                error(word.where, fmt::format("'{}' is not an option", word.value), "expected set option=value");
                continue;
            }
            word.name = whole_option(word.name);
            script_.options[word.name] = word;
        }
    }
    void set_kv_base(std::vector<Word>& words) {
        std::string bus;
        for (Word const& word : words) {
            if (word.name == "bus" || (word.name.empty() && bus.empty())) {
                bus = lower(word.value.substr(0, word.value.find('.')));
            } else {
                Word kv = word;
                kv.name = word.name.starts_with("kvln") ? "kvln" : "kvll";
                script_.bus_bases.emplace_back(bus, kv);
            }
        }
    }
    void clear(std::vector<Word>& /*words*/) {
        auto options = std::move(script_.options);
        script_ = {};
        // What is set before a circuit is made outlives it.
        if (auto it = options.find("defaultbasefrequency"); it != options.end()) {
            script_.options.insert(*it);
        }
        active_ = nullptr;
        values_ = 0;
    }
    void solve(std::vector<Word>& words) {
        set(words);
        ++script_.solves;
        script_.changed_since_solve = false;
    }
    void nothing(std::vector<Word>& /*words*/) {} // shows, plots, exports, or is done anyway
    void leave_out(std::vector<Word>& /*words*/) {
        script_.left_out.push_back({here_, fmt::format("the command '{}'", command_), true});
    }

    ReadDssFile const& read_;
    config::Diagnostics& diagnostics_;
    Script script_;
    Object* active_{nullptr};
    bool ignoring_{false}; ///< the active object is of a class that is not modelled
    bool stopped_{false};
    std::string last_class_, folder_;
    SourceMark here_;
    std::string_view command_;
    std::map<std::string, Word> variables_;
    std::vector<std::string> stack_;
    std::size_t octets_{0}, values_{0};
};

std::vector<Interpreter::Command> const& Interpreter::commands() {
    using I = Interpreter;
    static std::vector<Command> const kCommands = [] {
        std::vector<Command> out{{"new", &I::make},
                                 {"edit", &I::edit},
                                 {"more", &I::more},
                                 {"~", &I::more},
                                 {"redirect", &I::redirect},
                                 {"compile", &I::compile},
                                 {"clear", &I::clear},
                                 {"clearall", &I::clear},
                                 {"set", &I::set},
                                 {"solve", &I::solve},
                                 {"setkvbase", &I::set_kv_base},
                                 {"batchedit", &I::batch_edit},
                                 {"enable", &I::enable},
                                 {"disable", &I::disable},
                                 {"open", &I::open},
                                 {"close", &I::close},
                                 {"var", &I::define_variables}};
        for (std::string const& name : split(kOtherCommands, ' ')) {
            bool const changes = name.ends_with('!');
            out.push_back({changes ? name.substr(0, name.size() - 1) : name, changes ? &I::leave_out : &I::nothing});
        }
        return out;
    }();
    return kCommands;
}

} // namespace

Object const* Script::find(std::string_view class_name, std::string_view name) const {
    auto const it = index.find(fmt::format("{}.{}", class_name, name));
    return it == index.end() ? nullptr : &objects[it->second];
}

Script run_script(DssFile const& main, ReadDssFile const& read, config::Diagnostics& diagnostics,
                  std::vector<std::string> const& commands_after) {
    Interpreter interpreter{read, diagnostics};
    interpreter.run(main);
    if (!commands_after.empty()) {
        interpreter.run({join(commands_after, "\n"), "--command", main.folder});
    }
    return interpreter.take();
}

} // namespace gridspace::opendss
