// Errors of a configuration name the place, what was found and what was expected.
#include "dds_gateway/dds/configuration.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "common/files/certificate_folder.hpp"
#include "dds_gateway/dds/domain.hpp"
#include "dds_gateway/dds/endpoint.hpp"
#include "dds_gateway/dds/error.hpp"
#include "dds_gateway/ros/ros_type.hpp"
#include "tests/support/temporary_folder.hpp"

namespace lab::dds {
namespace {

using testing::AllOf;
using testing::HasSubstr;

template <class Action>
std::string errorOf(Action action) {
  try {
    action();
  } catch (const DdsError& error) {
    return error.what();
  }
  return "no error";
}

std::string errorOfConfiguration(const std::string& configuration) {
  return errorOf([&] { const Domain dut(3, configuration, "gateway.configuration (my.xml)"); });
}

std::string inDomain(const std::string& inside) {
  return "<CycloneDDS><Domain Id=\"any\">" + inside + "</Domain></CycloneDDS>";
}

TEST(Configuration, TheLabsConfigurationsAreAccepted) {
  EXPECT_EQ(errorOfConfiguration(localConfiguration()), "no error");
  EXPECT_EQ(errorOfConfiguration(networkConfiguration({.address = "127.0.0.1"})), "no error");
  EXPECT_EQ(errorOfConfiguration(networkConfiguration(
                {.address = "127.0.0.1", .peers = {"10.0.0.1", "10.0.0.2"}, .multicast = false})),
            "no error");
}

TEST(Configuration, UnknownElementIsNamed) {
  EXPECT_THAT(errorOfConfiguration(inDomain("<General><NoSuchThing>1</NoSuchThing></General>")),
              AllOf(HasSubstr("gateway.configuration (my.xml)"), HasSubstr("NoSuchThing"),
                    HasSubstr("DDS domain 3")));
}

// An element of a newer Cyclone.
TEST(Configuration, UnknownAttributeIsNamed) {
  EXPECT_THAT(
      errorOfConfiguration(inDomain("<General><Interfaces><NetworkInterface address=\"127.0.0.1\" "
                                    "allow_multicast=\"spdp\"/></Interfaces></General>")),
      AllOf(HasSubstr("my.xml"), HasSubstr("allow_multicast")));
}

TEST(Configuration, WrongValueIsNamed) {
  EXPECT_THAT(
      errorOfConfiguration(inDomain("<General><MaxMessageSize>much</MaxMessageSize></General>")),
      AllOf(HasSubstr("my.xml"), HasSubstr("MaxMessageSize"), HasSubstr("much")));
}

TEST(Configuration, ATextThatIsNotADocumentIsRefused) {
  for (const std::string text : {"", "my.xml", "<CycloneDDS><Domain>", "\n <Other/>"}) {
    EXPECT_THAT(errorOfConfiguration(text),
                AllOf(HasSubstr("gateway.configuration (my.xml)"), HasSubstr('"' + text + '"'),
                      HasSubstr("<CycloneDDS> ... </CycloneDDS>")));
  }
}

TEST(Configuration, ANameOfAFolderCannotContinueTheDocument) {
  const TemporaryFolder parent;
  for (const std::string name :
       {"a</IdentityCA></Authentication><Authentication><Library path=\"x.so\"", "a&b", "$HOME"}) {
    const std::filesystem::path folder = parent.path() / name;
    std::filesystem::create_directories(folder);
    for (const std::string_view file : kSecurityFiles) std::ofstream(folder / file) << "x";
    EXPECT_THAT(errorOf([&] {
                  (void)networkConfiguration({.address = "127.0.0.1", .security = folder.string()});
                }),
                AllOf(HasSubstr("found the folder of certificates"), HasSubstr("rename it")));
  }
}

TEST(Configuration, CertificatesAreRegularFiles) {
  const TemporaryFolder folder;
  for (const std::string_view file : kSecurityFiles) {
    std::filesystem::create_symlink("/dev/zero", folder.path() / file);
  }
  EXPECT_THAT(
      errorOf([&] {
        (void)networkConfiguration({.address = "127.0.0.1", .security = folder.path().string()});
      }),
      HasSubstr("identity_ca.pem: not found, or no regular file"));
}

TEST(Configuration, CertificatesAreFilesOfTheirFolder) {
  const TemporaryFolder parent;
  const std::filesystem::path folder = parent / "keys";
  std::filesystem::create_directories(folder);
  for (const std::string_view file : kSecurityFiles) std::ofstream(folder / file) << "x";
  const auto error = [&] {
    return errorOf(
        [&] { (void)networkConfiguration({.address = "127.0.0.1", .security = folder.string()}); });
  };
  EXPECT_EQ(error(), "no error");
  std::filesystem::rename(folder / "key.pem", parent / "key.pem");
  std::filesystem::create_symlink("../key.pem", folder / "key.pem");
  EXPECT_THAT(error(), HasSubstr("key.pem: found a link to "));
}

TEST(Configuration, AnAddressThatThisHostDoesNotHaveIsNamed) {
  EXPECT_THAT(errorOfConfiguration(networkConfiguration({.address = "192.0.2.7"})),
              HasSubstr("192.0.2.7"));
}

TEST(Configuration, AnInvalidAddressIsRefused) {
  for (const std::string address : {"", "robot-bench", "192.168.1", "1.2.3.4/24", "::1"}) {
    EXPECT_THAT(errorOf([&] { (void)networkConfiguration({.address = address}); }),
                AllOf(HasSubstr('"' + address + '"'), HasSubstr("IPv4")));
    EXPECT_THAT(
        errorOf([&] { (void)networkConfiguration({.address = "127.0.0.1", .peers = {address}}); }),
        HasSubstr('"' + address + '"'));
  }
  // inet_pton() reads up to the zero only.
  const std::string longer("1.2.3.4\0\"/>", 11);
  EXPECT_THAT(errorOf([&] { (void)networkConfiguration({.address = longer}); }),
              HasSubstr("found the address \"1.2.3.4"));
}

TEST(Configuration, AMissingCertificateFileIsNamed) {
  EXPECT_THAT(
      errorOf([] { (void)networkConfiguration({.address = "127.0.0.1", .security = "/nowhere"}); }),
      AllOf(HasSubstr("/nowhere/identity_ca.pem"), HasSubstr("docs/security.md")));
}

// After an error the same process can create a domain.
TEST(Configuration, AfterAnErrorTheProcessCanTryAgain) {
  EXPECT_NE(errorOfConfiguration(inDomain("<NoSuchThing/>")), "no error");
  EXPECT_EQ(takeWarnings(), "");
  EXPECT_EQ(errorOfConfiguration(localConfiguration()), "no error");
  EXPECT_EQ(takeWarnings(), "");
}

TEST(Configuration, AnInvalidTopicNameIsNamed) {
  const Domain dut(3, localConfiguration(), "test");
  const ros::RosType& type = ros::rosType<ros::Clock>();
  EXPECT_THAT(
      errorOf([&] { const Writer writer(dut, *type.descriptor, "rt/a b", ros::defaultQos(type)); }),
      HasSubstr("rt/a b"));
}

}  // namespace
}  // namespace lab::dds
