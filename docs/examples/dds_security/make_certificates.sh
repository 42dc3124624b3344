#!/bin/sh
# Certificates for DDS Security (docs/security.md).
#   make_certificates.sh FOLDER NAME... [--watch NAME...]
# Makes FOLDER/ca (whoever has its key can let others in: keep it to yourself), and for each name a
# folder FOLDER/NAME (gateway.security, link.security). Names after --watch may listen, not speak.
# Called again it adds names to the CA that is there.
set -eu
umask 077

days=3650
domain_max=230 # more is refused by Cyclone 0.10.2

die() {
  echo "make_certificates.sh: $*" >&2
  exit 1
}

[ $# -ge 2 ] || die "usage: make_certificates.sh FOLDER NAME... [--watch NAME...]"
command -v openssl >/dev/null || die "openssl is not installed: apt-get install openssl"
folder=$1
shift
mkdir -p "$folder/ca"
ca=$(cd "$folder/ca" && pwd)

if [ ! -e "$ca/key.pem" ]; then
  openssl ecparam -name prime256v1 -genkey -noout -out "$ca/key.pem"
  openssl req -x509 -new -key "$ca/key.pem" -sha256 -days "$days" -subj "/CN=Active Lab CA" \
    -out "$ca/cert.pem"
fi

sign() { # sign WHAT.xml AS.p7s
  openssl smime -sign -text -in "$1" -out "$2" -signer "$ca/cert.pem" -inkey "$ca/key.pem"
}

# Nobody unknown, everything encrypted: as SROS 2 has it.
cat >"$ca/governance.xml" <<EOF
<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
  xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_governance.xsd">
  <domain_access_rules>
    <domain_rule>
      <domains><id_range><min>0</min><max>$domain_max</max></id_range></domains>
      <allow_unauthenticated_participants>false</allow_unauthenticated_participants>
      <enable_join_access_control>true</enable_join_access_control>
      <discovery_protection_kind>ENCRYPT</discovery_protection_kind>
      <liveliness_protection_kind>ENCRYPT</liveliness_protection_kind>
      <rtps_protection_kind>SIGN</rtps_protection_kind>
      <topic_access_rules>
        <topic_rule>
          <topic_expression>*</topic_expression>
          <enable_discovery_protection>true</enable_discovery_protection>
          <enable_liveliness_protection>true</enable_liveliness_protection>
          <enable_read_access_control>true</enable_read_access_control>
          <enable_write_access_control>true</enable_write_access_control>
          <metadata_protection_kind>ENCRYPT</metadata_protection_kind>
          <data_protection_kind>ENCRYPT</data_protection_kind>
        </topic_rule>
      </topic_access_rules>
    </domain_rule>
  </domain_access_rules>
</dds>
EOF
sign "$ca/governance.xml" "$ca/governance.p7s"

permissions() { # permissions NAME MAY_SPEAK
  speak=
  [ "$2" = no ] || speak="<publish><topics><topic>*</topic></topics></publish>"
  cat <<EOF
<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
  xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_permissions.xsd">
  <permissions>
    <grant name="$1">
      <subject_name>CN=$1</subject_name>
      <validity>
        <not_before>$(date -u -d "-1 day" +%Y-%m-%dT%H:%M:%S)</not_before>
        <not_after>$(date -u -d "+$days days" +%Y-%m-%dT%H:%M:%S)</not_after>
      </validity>
      <allow_rule>
        <domains><id_range><min>0</min><max>$domain_max</max></id_range></domains>
        $speak
        <subscribe><topics><topic>*</topic></topics></subscribe>
      </allow_rule>
      <default>DENY</default>
    </grant>
  </permissions>
</dds>
EOF
}

may_speak=yes
for name; do
  if [ "$name" = --watch ]; then
    may_speak=no
    continue
  fi
  case $name in
    ca | *[!A-Za-z0-9_.-]* | [-.]* | "")
      die "found the name \"$name\", expected letters, digits, _, -, . (not ca)" ;;
  esac
  host=$folder/$name
  mkdir -p "$host"
  openssl ecparam -name prime256v1 -genkey -noout -out "$host/key.pem"
  openssl req -new -key "$host/key.pem" -subj "/CN=$name" -out "$host/request.pem"
  openssl x509 -req -in "$host/request.pem" -CA "$ca/cert.pem" -CAkey "$ca/key.pem" \
    -CAcreateserial -sha256 -days "$days" -out "$host/cert.pem" 2>/dev/null
  permissions "$name" "$may_speak" >"$host/permissions.xml"
  sign "$host/permissions.xml" "$host/permissions.p7s"
  cp "$ca/cert.pem" "$host/identity_ca.pem"
  cp "$ca/cert.pem" "$host/permissions_ca.pem"
  cp "$ca/governance.p7s" "$host/governance.p7s"
  rm "$host/request.pem" "$host/permissions.xml"
  echo "$host: $([ "$may_speak" = yes ] && echo "may listen and speak" || echo "may listen")"
done
