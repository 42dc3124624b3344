#include "robot/language/spelled_name.hpp"

#include <array>
#include <utility>

namespace lab::language {
namespace {

struct GreekLetter {
  std::string_view letter;
  std::string_view name;
};

constexpr std::array<GreekLetter, 53> kGreekLetters{{
    {"\u03b1", "alpha"},   {"\u03b2", "beta"},    {"\u03b3", "gamma"},   {"\u03b4", "delta"},
    {"\u03b5", "epsilon"}, {"\u03b6", "zeta"},    {"\u03b7", "eta"},     {"\u03b8", "theta"},
    {"\u03b9", "iota"},    {"\u03ba", "kappa"},   {"\u03bb", "lambda"},  {"\u03bc", "mu"},
    {"\u03bd", "nu"},      {"\u03be", "xi"},      {"\u03bf", "omicron"}, {"\u03c0", "pi"},
    {"\u03c1", "rho"},     {"\u03c2", "sigma"},   {"\u03c3", "sigma"},   {"\u03c4", "tau"},
    {"\u03c5", "upsilon"}, {"\u03c6", "phi"},     {"\u03c7", "chi"},     {"\u03c8", "psi"},
    {"\u03c9", "omega"},   {"\u0391", "Alpha"},   {"\u0392", "Beta"},    {"\u0393", "Gamma"},
    {"\u0394", "Delta"},   {"\u0395", "Epsilon"}, {"\u0396", "Zeta"},    {"\u0397", "Eta"},
    {"\u0398", "Theta"},   {"\u0399", "Iota"},    {"\u039a", "Kappa"},   {"\u039b", "Lambda"},
    {"\u039c", "Mu"},      {"\u039d", "Nu"},      {"\u039e", "Xi"},      {"\u039f", "Omicron"},
    {"\u03a0", "Pi"},      {"\u03a1", "Rho"},     {"\u03a3", "Sigma"},   {"\u03a4", "Tau"},
    {"\u03a5", "Upsilon"}, {"\u03a6", "Phi"},     {"\u03a7", "Chi"},     {"\u03a8", "Psi"},
    {"\u03a9", "Omega"},   {"\u00b5", "mu"},      {"\u03d1", "theta"},   {"\u03d5", "phi"},
    {"\u03f5", "epsilon"},
}};

}  // namespace

std::string_view greekLetterIn(std::string_view line) {
  for (std::size_t at = 0; at < line.size(); ++at) {
    for (const GreekLetter& greek : kGreekLetters) {
      if (line.substr(at).starts_with(greek.letter)) return line.substr(at, greek.letter.size());
    }
  }
  return {};
}

std::string spelledAdvice(std::string_view name) {
  std::string spelled(name);
  bool changed = false;
  for (const GreekLetter& greek : kGreekLetters) {
    for (std::size_t at = spelled.find(greek.letter); at != std::string::npos;
         at = spelled.find(greek.letter)) {
      spelled.replace(at, greek.letter.size(), greek.name);
      changed = true;
    }
  }
  return changed ? "; write " + spelled : "";
}

}  // namespace lab::language
