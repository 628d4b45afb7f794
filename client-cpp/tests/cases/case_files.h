// Reads the cases that all clients share (tests/clients/README.md) and runs their steps.
#pragma once

#include <google/protobuf/message.h>
#include <google/protobuf/struct.pb.h>

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

namespace thunderhead::client::testing {

using Json = google::protobuf::Value;

// A case that the runner does not understand, or whose result differs.
class CaseError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The arguments of one step of a case, or the values of `given`, the state before the first step.
// The class records which arguments were read. ExpectAllRead can therefore fail for an argument
// that the client's runner does not know. The methods throw a CaseError if an argument is absent or
// has another type.
class Arguments {
 public:
  explicit Arguments(google::protobuf::Struct values) : values_(std::move(values)) {}

  const Json& Get(const std::string& name);
  double Number(const std::string& name, std::optional<double> otherwise = {});
  std::string Text(const std::string& name);
  bool Flag(const std::string& name, std::optional<bool> otherwise = {});
  std::vector<double> Numbers(const std::string& name);
  // Reads a message that is written as Protobuf JSON.
  void Read(const std::string& name, google::protobuf::Message& message);
  template <typename Message>
  Message Read(const std::string& name) {
    Message message;
    Read(name, message);
    return message;
  }
  // Throws a CaseError if an argument was not read.
  void ExpectAllRead() const;

 private:
  const Json* Find(const std::string& name);

  google::protobuf::Struct values_;
  std::set<std::string> read_;
};

std::vector<double> NumbersOf(const Json& list);

Json JsonOf(double number);
Json JsonOf(bool flag);
Json JsonOf(const std::string& text);
Json JsonOf(const google::protobuf::Message& message);
Json JsonOf(const std::vector<Json>& list);
Json Null();

// The results of a step that a case can expect, by name.
using Results = std::map<std::string, Json>;
using Actions = std::map<std::string, std::function<Results(Arguments&)>>;
// Makes a module in the given state, and returns the actions of its steps.
using Runner = std::function<Actions(Arguments& given)>;

struct Case {
  std::string file;  // name of the case file without ".json"
  std::string name;
  google::protobuf::Struct given;
  std::vector<google::protobuf::Struct> steps;
};

// Returns the cases of every file that lists `client` among the clients that have its module.
// Throws a CaseError if a file cannot be read.
std::vector<Case> CasesOf(const std::string& client);

// Throws a CaseError that names the step if the module does not do what the case expects.
void RunCase(const Runner& runner, const Case& each);

}  // namespace thunderhead::client::testing
