// A robot that speaks DDS by another implementation: it publishes a Boolean and prints guarantees.
//
// Usage: fastdds_peer DOMAIN; then a line on stdin for each sample: 0 or 1. Types match by name alone,
// as those of rclcpp do, and bytes are written and read here, by nobody's generator.
#include <cstring>
#include <iostream>
#include <string>
#include <vector>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>

using namespace eprosima::fastdds::dds;
using eprosima::fastrtps::rtps::InstanceHandle_t;
using eprosima::fastrtps::rtps::SerializedPayload_t;
using Bytes = std::vector<unsigned char>;

class Raw : public TopicDataType {
 public:
  explicit Raw(const std::string& name) {
    setName(name.c_str());
    m_typeSize = 4096;
    m_isGetKeyDefined = false;
    auto_fill_type_object(false);
    auto_fill_type_information(false);
  }
  bool serialize(void* data, SerializedPayload_t* payload) override {
    const Bytes& bytes = *static_cast<Bytes*>(data);
    payload->encapsulation = CDR_LE;
    payload->length = static_cast<uint32_t>(bytes.size());
    std::memcpy(payload->data, bytes.data(), bytes.size());
    return true;
  }
  bool deserialize(SerializedPayload_t* payload, void* data) override {
    static_cast<Bytes*>(data)->assign(payload->data, payload->data + payload->length);
    return true;
  }
  std::function<uint32_t()> getSerializedSizeProvider(void* data) override {
    const auto size = static_cast<uint32_t>(static_cast<Bytes*>(data)->size());
    return [size] { return size; };
  }
  void* createData() override { return new Bytes; }
  void deleteData(void* data) override { delete static_cast<Bytes*>(data); }
  bool getKey(void*, InstanceHandle_t*, bool) override { return false; }
};

class Guarantees : public DataReaderListener {
  void on_data_available(DataReader* reader) override {
    Bytes bytes;
    SampleInfo info;
    while (reader->take_next_sample(&bytes, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) print(bytes);
    }
  }
  static uint32_t number(const Bytes& bytes, size_t& at) {
    at = (at + 3) / 4 * 4;
    uint32_t found = 0;
    std::memcpy(&found, bytes.data() + at, 4);
    at += 4;
    return found;
  }
  static void print(const Bytes& bytes) {  // behind the header: count, then id and active of each
    size_t at = 4;
    std::string active;
    for (uint32_t left = number(bytes, at); left > 0; --left) {
      const uint32_t length = number(bytes, at);
      const std::string id(bytes.begin() + at, bytes.begin() + at + length - 1);
      at += length;
      if (bytes[at++]) active += " " + id;
    }
    std::cout << "active" << active << std::endl;
  }
};

int main(int, char** argv) {
  DomainParticipantQos qos;
  auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.push_back("127.0.0.1");
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  qos.wire_protocol().builtin.discovery_config.leaseDuration_announcementperiod = {0, 500000000};
  auto* participant =
      DomainParticipantFactory::get_instance()->create_participant(std::stoi(argv[1]), qos);
  if (participant == nullptr) return 1;
  TypeSupport boolean(new Raw("std_msgs::msg::dds_::Bool_"));
  TypeSupport output(new Raw("eddi_messages::msg::dds_::ConSertOutput_"));
  boolean.register_type(participant);
  output.register_type(participant);
  auto* in = participant->create_topic("rt/in/healthy", boolean.get_type_name(), TOPIC_QOS_DEFAULT);
  auto* out =
      participant->create_topic("rt/rover/guarantees", output.get_type_name(), TOPIC_QOS_DEFAULT);
  DataWriterQos writing;
  writing.reliability().kind = RELIABLE_RELIABILITY_QOS;
  auto* writer = participant->create_publisher(PUBLISHER_QOS_DEFAULT)->create_datawriter(in, writing);
  DataReaderQos reading;
  reading.reliability().kind = RELIABLE_RELIABILITY_QOS;
  reading.durability().kind = TRANSIENT_LOCAL_DURABILITY_QOS;
  Guarantees guarantees;
  participant->create_subscriber(SUBSCRIBER_QOS_DEFAULT)
      ->create_datareader(out, reading, &guarantees);
  std::cout << "ready" << std::endl;
  for (std::string line; std::getline(std::cin, line);) {
    Bytes sample = {0, 1, 0, 0, static_cast<unsigned char>(line == "1")};
    writer->write(&sample);
  }
  participant->delete_contained_entities();
  DomainParticipantFactory::get_instance()->delete_participant(participant);
  return 0;
}
