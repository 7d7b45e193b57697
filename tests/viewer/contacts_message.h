// contacts_of() decodes a contacts message.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

#include "viewer/server/pair_history.h"

namespace throng {

struct ContactsMessage {
  ContactsHead head;
  std::vector<ContactRecord> records;
};

/// `bytes`: a container of bytes. Fails the test if its size or kind is wrong.
template <typename Container>
ContactsMessage contacts_of(const Container& bytes) {
  ContactsMessage message;
  if (bytes.size() < sizeof message.head) {
    ADD_FAILURE() << "a message of " << bytes.size() << " bytes";
    return message;
  }
  std::memcpy(&message.head, bytes.data(), sizeof message.head);
  EXPECT_EQ(message.head.kind, kContactsMessage);
  message.records.resize((bytes.size() - sizeof message.head) / sizeof(ContactRecord));
  EXPECT_EQ(message.head.count, message.records.size());
  EXPECT_EQ(bytes.size(), sizeof message.head + message.records.size() * sizeof(ContactRecord));
  if (!message.records.empty())
    std::memcpy(message.records.data(), bytes.data() + sizeof message.head,
                message.records.size() * sizeof(ContactRecord));
  return message;
}

}  // namespace throng
