// Expressions: values against arithmetic done here, what they measure, and what is wrong with them.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "base/math.h"
#include "tests/pxn/expressions.h"

namespace panwright::pxn::expression_test {
namespace {

using schemas::Dimension;
using Fixture = ExpressionFixture;

double ulps(double a, double b) {
  const double ulp =
      std::nextafter(std::fabs(b), std::numeric_limits<double>::infinity()) - std::fabs(b);
  return std::fabs(a - b) / ulp;
}

// ---- values

TEST(Expression, PrecedenceAndAssociativity) {
  Fixture at;
  const std::pair<const char*, double> cases[] = {
      {"1 + 2*3", 7},
      {"(1 + 2)*3", 9},
      {"3 - 2 - 1", 0},
      {"8/4/2", 1},
      {"2^3^2", 512},
      {"-2^2", -4},
      {"(-2)^2", 4},
      {"-1^0.5", -1},
      {"2^-1", 0.5},
      {"2^-1^2", 0.5},
      {"2^-2*8", 2},
      {"2*-3", -6},
      {"--3", 3},
      {"- + -3", 3},
      {"3 - -2", 5},
      {"-2*3 + 1", -5},
      {"!0", 1},
      {"!0 == 1", 1},
      {"!(1 == 1)", 0},
      {"1 < 2 && 2 < 3", 1},
      {"(1 < 2) == 1", 1},
      {"2 <= 2 || 1 > 3", 1},
      {"0 || 0 && 1", 0},
      {"1 || 1 && 0", 1},
      {"1 != 1 + 1", 1},
      {"1 + 1 >= 2", 1},
      {"0 ? 1 : 0 ? 2 : 3", 3},
      {"1 ? 0 ? 4 : 5 : 6", 5},
      {"1 ? 2 : 3 + 10", 2},
      {"0 ? 2 : 3 + 10", 13},
      {"1 < 2 ? 3 : 4 < 5 ? 6 : 7", 3},
      {"2 > 1 ? 3 > 4 ? 1 : 2 : 3", 2},
      {"max(1, 0 ? 5 : 2)", 2},
      {"5", 5},
      {"\t(\n((5)) ) \r", 5},
      {".5 + 5.", 5.5},
      {"1e3 + 1E-3", 1000.001},
      {"0.1 + 0.2", 0.1 + 0.2},
      {"pi", 3.141592653589793},
      {"tau", 6.283185307179586},
  };
  for (const auto& [text, expected] : cases) EXPECT_EQ(at.value(text), expected) << text;
}

TEST(Expression, UnitsAreExact) {
  Fixture at;
  EXPECT_EQ(at.value("5mm"), 0.005);
  EXPECT_EQ(at.value("12in"), 0.3048);
  EXPECT_EQ(at.value("180deg"), kPi);
  EXPECT_EQ(at.value("2e3km"), 2e6);
  EXPECT_EQ(at.value("3\u00b5m"), 3e-6);
  EXPECT_EQ(at.value("25% + 0.25"), 0.5);
  EXPECT_EQ(at.value("-1mrad"), -0.001);
  EXPECT_EQ(at.value("30deg"), 0.5235987755982989);  // of π/6; kPi/6 is an ulp below
}

TEST(Expression, FunctionsHoldLibmToAnUlp) {
  Fixture at;
  struct Case {
    const char* name;
    double (*expected)(double);
    double (*own)(double);
    double low;
    double high;
  };
  const Case cases[] = {
      {"sin", std::sin, det::sin, -30, 30},         {"cos", std::cos, det::cos, -30, 30},
      {"tan", std::tan, det::tan, -1.5, 1.5},       {"asin", std::asin, det::asin, -1, 1},
      {"acos", std::acos, det::acos, -1, 1},        {"atan", std::atan, det::atan, -50, 50},
      {"exp", std::exp, det::exp, -700, 700},       {"log", std::log, det::log, 1e-9, 1e9},
      {"log10", std::log10, det::log10, 1e-9, 1e9}, {"sqrt", std::sqrt, std::sqrt, 0, 1e12},
      {"abs", std::fabs, std::fabs, -9, 9},         {"floor", std::floor, std::floor, -9, 9},
      {"ceil", std::ceil, std::ceil, -9, 9},        {"round", std::round, std::round, -9, 9},
  };
  std::mt19937_64 random(7);
  double worst = 0;
  at.expressions.set_units({find_unit("m"), find_unit("rad")});
  for (const Case& c : cases) {
    const std::string text = std::string(c.name) + "(x)";
    const std::uint64_t place = at.place++;
    for (int i = 0; i < 2000; ++i) {
      const double x = c.low + (c.high - c.low) * static_cast<double>(random() >> 11) * 0x1p-53;
      at.scope.set("x", {x, Dimension::none});
      const auto measured = at.expressions.evaluate(text, place, &at.scope, at.problem);
      ASSERT_TRUE(measured) << text << " at " << x;
      ASSERT_EQ(measured->value, c.own(x)) << text << " at " << x;
      worst = std::max(worst, ulps(measured->value, c.expected(x)));
    }
  }
  // both are within an ulp of the truth, and rounded; measured: 1
  EXPECT_LE(worst, 1);
  EXPECT_EQ(at.value("atan2(-1, -1)"), det::atan2(-1, -1));
  EXPECT_EQ(at.value("atan2(1, 0)"), kPi / 2);
  EXPECT_EQ(at.value("hypot(3, 4)"), 5);
  EXPECT_EQ(at.value("hypot(3*2^700, 4*2^700)/2^700"), 5);
  EXPECT_EQ(at.value("round(2.5) + round(-2.5) + round(0.5)"), 1);
  EXPECT_EQ(at.value("sign(-3) + 10*sign(0) + 100*sign(5)"), 99);
  EXPECT_EQ(at.value("min(3, -1, 2)"), -1);
  EXPECT_EQ(at.value("max(3)"), 3);
  EXPECT_EQ(at.value("mod(7, 3)"), 1);
  EXPECT_EQ(at.value("mod(-1, 3)"), 2);
  EXPECT_EQ(at.value("mod(1, -3)"), -2);
  EXPECT_EQ(at.value("mod(-6, 3)"), 0);
  for (int base = 0; base <= 20; ++base)
    for (int k = 0; k <= 10; ++k) {
      double product = 1;  // exact: 20^10 is below 2^53
      for (int i = 0; i < k; ++i) product *= base;
      EXPECT_EQ(at.value(std::to_string(base) + "^" + std::to_string(k)), product);
    }
}

// Trees that are printed with as few parentheses as precedence allows, and evaluated as trees.
struct Tree {
  enum class Kind { leaf, negative, binary, choice } kind = Kind::leaf;
  int op = 0;
  double value = 0;
  std::string name;
  std::unique_ptr<Tree> a, b, c;
};
constexpr const char* kOps[] = {"||", "&&", "==", "!=", "<", "<=", "+", "-", "*", "/"};
constexpr int kPrecedence[] = {1, 2, 3, 3, 4, 4, 5, 5, 6, 6};

std::unique_ptr<Tree> random_tree(std::mt19937& random, int depth) {
  auto tree = std::make_unique<Tree>();
  const unsigned kind = depth == 0 ? 0 : random() % 8;
  if (kind == 0) {
    tree->value = static_cast<double>(random() % 40) / 8;
    if (random() % 2 == 0) tree->name = std::string(1, static_cast<char>('p' + random() % 4));
  } else if (kind == 1) {
    tree->kind = Tree::Kind::negative;
    tree->a = random_tree(random, depth - 1);
  } else if (kind == 2) {
    tree->kind = Tree::Kind::choice;
    tree->a = random_tree(random, depth - 1);
    tree->b = random_tree(random, depth - 1);
    tree->c = random_tree(random, depth - 1);
  } else {
    tree->kind = Tree::Kind::binary;
    tree->op = static_cast<int>(random() % std::size(kOps));
    tree->a = random_tree(random, depth - 1);
    tree->b = random_tree(random, depth - 1);
  }
  return tree;
}

int precedence(const Tree& tree) {
  switch (tree.kind) {
    case Tree::Kind::choice:
      return 0;
    case Tree::Kind::binary:
      return kPrecedence[tree.op];
    case Tree::Kind::negative:
      return 7;
    default:
      return 9;
  }
}

std::string print(const Tree& tree, std::mt19937& random) {
  const auto part = [&](const Tree& t, int at_least) {
    const std::string text = print(t, random);
    return precedence(t) < at_least ? "(" + text + ")" : text;
  };
  const std::string gap = random() % 2 == 0 ? " " : "";
  switch (tree.kind) {
    case Tree::Kind::leaf: {
      if (!tree.name.empty()) return tree.name;
      std::string text = std::to_string(tree.value);
      return text;
    }
    case Tree::Kind::negative:
      return "-" + gap + part(*tree.a, 7);
    case Tree::Kind::choice:
      return part(*tree.a, 1) + gap + "?" + gap + print(*tree.b, random) + gap + ":" +
             print(*tree.c, random);
    case Tree::Kind::binary:
      break;
  }
  const int own = kPrecedence[tree.op];
  // comparisons do not chain: those of both kinds are put in parentheses
  const bool compares = own == 3 || own == 4;
  return part(*tree.a, compares ? 5 : own) + gap + kOps[tree.op] + gap +
         part(*tree.b, compares ? 5 : own + 1);
}

// Nothing where an operation has no finite result.
std::optional<double> value_of(const Tree& tree, const double* names) {
  switch (tree.kind) {
    case Tree::Kind::leaf:
      return tree.name.empty() ? tree.value : names[tree.name[0] - 'p'];
    case Tree::Kind::negative: {
      const auto a = value_of(*tree.a, names);
      return a ? std::optional(-*a) : a;
    }
    case Tree::Kind::choice: {
      const auto a = value_of(*tree.a, names);
      return a ? value_of(*a != 0 ? *tree.b : *tree.c, names) : a;
    }
    case Tree::Kind::binary:
      break;
  }
  const auto left = value_of(*tree.a, names), right = value_of(*tree.b, names);
  if (!left || !right) return std::nullopt;
  const double a = *left, b = *right;
  const double all[] = {double(a != 0 || b != 0),
                        double(a != 0 && b != 0),
                        double(a == b),
                        double(a != b),
                        double(a < b),
                        double(a <= b),
                        a + b,
                        a - b,
                        a * b,
                        a / b};
  return std::isfinite(all[tree.op]) ? std::optional(all[tree.op]) : std::nullopt;
}

TEST(Expression, RandomTreesHaveTheValuesOfTheTrees) {
  Fixture at;
  std::mt19937 random(3);
  const double names[] = {0, 1.5, -2, 0.125};
  for (int i = 0; i < 4; ++i)
    at.scope.set(std::string(1, static_cast<char>('p' + i)), {names[i], Dimension::none});
  int without = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto tree = random_tree(random, 1 + i % 6);
    const std::string text = print(*tree, random);
    if (text.size() > kLongestExpression) continue;
    const auto expected = value_of(*tree, names);
    const auto measured = at(text);
    ASSERT_EQ(measured.has_value(), expected.has_value()) << text << "\n" << at.problem.message;
    if (expected) {
      ASSERT_EQ(measured->value, *expected) << text;
    } else {
      ++without;
      ASSERT_EQ(at.problem.code, Code("E1223")) << text;
    }
  }
  EXPECT_GT(without, 100);
}

// ---- names

TEST(Expression, NamesAreLookedUpEachTime) {
  Fixture at;
  for (int i = 0; i < 5; ++i) {
    at.scope.set("i", {static_cast<double>(i), Dimension::none});
    const auto measured = at.expressions.evaluate("2*i + 1", 99, &at.scope, at.problem);
    ASSERT_TRUE(measured);
    EXPECT_EQ(measured->value, 2 * i + 1);
  }
  // an inner scope hides names, also of constants
  Scope inner(&at.scope);
  inner.set("i", {50, Dimension::none});
  inner.set("pi", {3, Dimension::none});
  EXPECT_EQ(at.expressions.evaluate("2*i + 1", 99, &inner, at.problem)->value, 101);
  EXPECT_EQ(at.expressions.evaluate("pi", 100, &inner, at.problem)->value, 3);
  EXPECT_FALSE(at.expressions.evaluate("2*i + 1", 99, nullptr, at.problem));
  EXPECT_EQ(at.problem.code, Code("E1222"));
  // names of units, functions and programs are free
  at.scope.set("mm", {7, Dimension::none});
  at.scope.set("e", {2, Dimension::none});
  at.scope.set("v00", {11, Dimension::none});
  at.scope.set("sin", {13, Dimension::none});
  EXPECT_EQ(at.value("2*mm + 1*e + v00"), 27);
  EXPECT_EQ(at.value("sin + sin(0)"), 13);
}

// ---- what is wrong

TEST(Expression, Problems) {
  Fixture at;
  at.scope.set("gap", {0.5, Dimension::length});
  at.scope.set("i", {3, Dimension::none});
  const std::pair<const char*, const char*> cases[] = {
      {"", "E1221 0-0 no expression between the braces"},
      {" ", "E1221 0-1 no expression between the braces"},
      {"1 +", "E1221 3-4 the expression ends where a value is needed"},
      {"*2", "E1221 0-1 a value is missing before '*'"},
      {"2**3", "E1221 2-3 a value is missing before '*' (powers are written ^)"},
      {"1 2", "E1221 2-3 an operator is missing before '2' (a product is written with *)"},
      {"2(3)", "E1221 1-2 an operator is missing before '(' (a product is written with *)"},
      {"(1)(2)", "E1221 3-4 an operator is missing before '(' (a product is written with *)"},
      {"5 mm",
       "E1221 2-4 an operator is missing before 'mm' (a unit follows its number without a "
       "blank)"},
      {"gap i", "E1221 4-5 an operator is missing before 'i' (a product is written with *)"},
      {"1.2.3", "E1221 3-4 an operator is missing before '.' (a product is written with *)"},
      {"(1 + 2", "E1221 0-1 this '(' is not closed"},
      {"sin(1", "E1221 0-3 the parenthesis after this is not closed"},
      {"1 + 2)", "E1221 5-6 unmatched ')'"},
      {"()", "E1221 1-2 a value is missing before ')'"},
      {"sin()", "E1221 4-5 no value between these parentheses"},
      {"max(1,)", "E1221 6-7 a value is missing before ')'"},
      {"sin(1, 2)", "E1221 0-3 sin takes 1 value, found more"},
      {"atan2(1)", "E1221 0-5 atan2 takes 2 values, found 1"},
      {"1, 2",
       "E1221 1-2 ',' outside the arguments of a function (numbers have a "
       "decimal point)"},
      {"1 ? 2", "E1221 2-3 this '?' has no ':' (write condition ? value : other)"},
      {"(1 ? 2) : 3", "E1221 3-4 this '?' has no ':' (write condition ? value : other)"},
      {"1 : 2", "E1221 2-3 ':' has no '?' before it"},
      {"1 = 2", "E1221 2-3 '=' is not an operator (equality is written ==)"},
      {"1 & 2", "E1221 2-3 '&' is not an operator (write && (in XML, &amp;&amp;))"},
      {"5 % 3",
       "E1221 2-3 '%' is not allowed in an expression (the remainder is written mod(a, b))"},
      {"1 < 2 < 3", "E1221 6-7 comparisons do not chain (write a < b && b < c)"},
      {"1 < 2 == 1", "E1221 6-8 comparisons do not chain (write a < b && b < c)"},
      {"!!1", "E1221 0-2 a sign or another '!' after '!' needs parentheses (write !(…))"},
      {"-!1", "E1221 1-2 a '!' after a sign needs parentheses (write -(!…))"},
      {"1 + {2}", "E1221 4-5 nested braces (inside braces, parentheses group)"},
      {"\"x\"", "E1221 0-1 '\"' is not allowed in an expression (expressions have no strings)"},
      {"2 + \u00b0", "E1221 4-6 '\u00b0' is not allowed in an expression"},
      {"2 \xff", "E1221 2-3 '\ufffd' is not allowed in an expression"},
      {"2gap",
       "E1213 1-4 unknown unit 'gap' (a product is written with *; units of length are m, mm, cm, "
       "km, um, nm, in or ft)"},
      {"2\u00b0", "E1213 1-3 unknown unit '\u00b0'"},
      {"2*gpa",
       "E1222 2-5 'gpa' is not a parameter or variable that is known here (did you mean "
       "'gap'?)"},
      {"sine(2)", "E1222 0-4 unknown function 'sine' (did you mean 'sin'?)"},
      {"gap(2)", "E1222 0-3 unknown function 'gap' (a product is written with *)"},
      {"cos",
       "E1222 0-3 'cos' is not a parameter or variable that is known here (functions take "
       "their values in parentheses: cos(…))"},
      {"1/0", "E1223 1-2 1 / 0 has no finite value (condition ? value : other can leave it out)"},
      {"0/0", "E1223 1-2 0 / 0 has no finite value (condition ? value : other can leave it out)"},
      {"mod(1, 0)",
       "E1223 0-3 mod(1, 0) has no finite value (condition ? value : other can leave it "
       "out)"},
      {"1 + log(gap - 0.5)", "E1223 4-7 log(0) has no finite value"},
      {"sqrt(2) + sqrt(-4)", "E1223 10-14 sqrt(-4) has no finite value"},
      {"(-8)^0.5", "E1223 4-5 (-8) ^ 0.5 has no finite value"},
      {"1e400", "E1223 0-5 '1e400' is past 1.8e308, the largest number"},
      {"2e308km", "E1223 0-7 '2e308' is past 1.8e308, the largest number"},
      {"1e300*1e300", "E1223 5-6 1e+300 * 1e+300 has no finite value"},
      {"0*(1e300*1e300)", "E1223 8-9 1e+300 * 1e+300 has no finite value"},
      {"1mm + 1deg",
       "E1212 0-10 a length and an angle cannot be added"
       " (a bare number is in m where it is a length, in deg where it is an angle)"},
      {"2*(gap*gap - 3*gap)",
       "E1212 3-18 an area and a length cannot be subtracted"
       " (a bare number is in m where it is a length, in deg where it is an angle)"},
      {"gap < 30deg ? 1 : 2",
       "E1212 0-11 a length and an angle cannot be compared"
       " (a bare number is in m where it is a length, in deg where it is an angle)"},
      {"1 == gap || gap != 3px",
       "E1212 12-22 a length and a number of pixels cannot be compared"
       " (a bare number is in m where it is a length, in deg where it is an angle)"},
      {"min(1mm, i, 2deg)",
       "E1212 4-16 min expects values of one dimension, got a length and an angle"
       " (a bare number is in m where it is a length, in deg where it is an angle)"},
      {"hypot(gap, 10%)",
       "E1212 6-14 hypot expects values of one dimension, got a length and a ratio"
       " (a bare number is in m where it is a length, in deg where it is an angle)"},
      {"1 + sin(2*gap)",
       "E1212 8-13 sin expects an angle, got a length"
       " (a bare number is in m where it is a length, in deg where it is an angle)"},
      {"gap - -(2px)",
       "E1212 0-11 a length and a number of pixels cannot be subtracted"
       " (a bare number is in m where it is a length, in deg where it is an angle)"},
      {"1/gap + gap",
       "E1212 0-11 a length to the power -1 and a length cannot be added"
       " (a bare number is in m where it is a length, in deg where it is an angle)"},
      {"(i > 2 ? 1mm : 2mm) + 1deg",
       "E1212 1-26 a length and an angle cannot be added"
       " (a bare number is in m where it is a length, in deg where it is an angle)"},
      {"atan(1/(i - 3))",
       "E1223 6-7 1 / 0 has no finite value (condition ? value : other can leave "
       "it out)"},
  };
  for (const auto& [text, expected] : cases) EXPECT_EQ(at.complaint(text), expected) << text;
  // a branch that is not taken has no problem
  EXPECT_EQ(at.value("i == 3 ? 0 : 1/(i - 3)"), 0);
}

// The operation that breaks is found wherever it stands.
TEST(Expression, TheCulpritIsFoundAmongMany) {
  Fixture at;
  for (int bad = 0; bad < 40; ++bad) {
    std::string text = "1";
    std::size_t place = 0;
    for (int i = 0; i < 40; ++i) {
      if (i == bad) place = text.size();
      text += i == bad ? "/0" : i % 3 == 0 ? "+sin(1deg)" : i % 3 == 1 ? "*1" : "/2";
    }
    EXPECT_FALSE(at(text));
    EXPECT_EQ(at.problem.begin, place) << text;
  }
}

// ---- limits

TEST(Expression, LengthAndDepth) {
  Fixture at;
  const auto sum = [](std::size_t bytes) {
    std::string text = bytes % 2 == 0 ? "10" : "1";
    while (text.size() < bytes) text += "+1";
    return text;
  };
  EXPECT_EQ(at.value(sum(4095)), 2048);
  EXPECT_EQ(at.value(sum(4096)), 10 + 2047);
  EXPECT_EQ(at.complaint(sum(4097)),
            "E1221 0-1 an expression of 4097 bytes, expected at most 4096 (<param> can name its "
            "parts)");
  EXPECT_EQ(at.value(std::string(2047, '(') + "7" + std::string(2047, ')')), 7);
  EXPECT_EQ(at.value(std::string(4095, '-') + "7"), -7);
  std::string functions = "7";
  for (int i = 0; i < 800; ++i) functions = "abs(" + functions + ")";
  EXPECT_EQ(at.value(functions), 7);
  std::string choices;
  for (int i = 0; i < 900; ++i) choices += "0?1:";
  EXPECT_EQ(at.value(choices + "7"), 7);
  std::string inner = "7";
  for (int i = 0; i < 900; ++i) inner = "1?" + inner + ":2";
  EXPECT_EQ(at.value(inner), 7);
  std::string powers = "1";
  for (int i = 0; i < 2000; ++i) powers += "^1";
  EXPECT_EQ(at.value(powers), 1);
  EXPECT_EQ(at(std::string(100000, '(')), std::nullopt);
  std::string many = "max(0";
  for (int i = 1; i < 1000; ++i) many += ",1";
  EXPECT_EQ(at.value(many + ")"), 1);
  EXPECT_EQ(at.complaint(many + ",1)").substr(0, 9), "E1221 0-3");
}

// What the reader lets pass can be evaluated, and places lie in the text, whatever the text is.
TEST(Expression, AnySoupOfTokensIsAnsweredFor) {
  Fixture at;
  at.scope.set("a", {2, Dimension::length});
  at.scope.set("b", {0, Dimension::angle});
  const std::string_view tokens[] = {
      "1", "2.5", "a",  "b",  "(",  ")",  "(",    ")",     "+",  "-",    "*", "/",   "^",
      "<", "<=",  "==", "!=", "&&", "||", "!",    "?",     ":",  ",",    " ", "sin", "max(",
      "{", "}",   "=",  "&",  "%",  "mm", "1e99", "0",     "pi", "min(", "#", "1?",  ":2",
      "$", "~",   "@",  "\"", "'",  ";",  "v00",  "sqrt(", "\\", "\xc2", "_"};
  std::mt19937 random(11);
  int good = 0;
  for (int i = 0; i < 200000; ++i) {
    std::string text;
    const unsigned n = 1 + random() % 9;
    for (unsigned k = 0; k < n; ++k) text += tokens[random() % std::size(tokens)];
    if (const auto measured = at(text)) {
      ++good;
      ASSERT_TRUE(std::isfinite(measured->value)) << text;
      continue;
    }
    ASSERT_LE(at.problem.begin, text.size()) << text;
    ASSERT_LE(at.problem.end, text.size() + 1) << text;
    ASSERT_LE(at.problem.begin, at.problem.end) << text;
    ASSERT_EQ(at.problem.message.find("cannot be read"), std::string::npos)
        << text << ": " << at.problem.message;
  }
  EXPECT_GT(good, 1000);
}

// More places and shapes than are kept give the same values.
TEST(Expression, MoreThanIsKept) {
  Fixture at;
  at.scope.set("i", {3, Dimension::none});
  for (int round = 0; round < 2; ++round)
    for (std::uint64_t k = 0; k < 1024; ++k) {
      std::string text = "i";
      double expected = 3;
      for (int bit = 0; bit < 10; ++bit) {
        const bool adds = ((k >> bit) & 1) != 0;
        text += adds ? "-1" : "+2";
        expected += adds ? -1 : 2;
      }
      const auto measured = at.expressions.evaluate(text, k, &at.scope, at.problem);
      ASSERT_TRUE(measured);
      ASSERT_EQ(measured->value, expected) << text;
    }
  for (std::uint64_t k = 0; k < 40000; ++k) {
    const auto measured =
        at.expressions.evaluate("i*" + std::to_string(k), 5000 + k, &at.scope, at.problem);
    ASSERT_EQ(measured->value, 3.0 * static_cast<double>(k));
  }
}

}  // namespace
}  // namespace panwright::pxn::expression_test
