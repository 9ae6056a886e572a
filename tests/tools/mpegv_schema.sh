#!/usr/bin/env bash
# SPDX-License-Identifier: LGPL-2.1-or-later
# Validates .sem.xml files with the schemas of ISO/IEC 23005-3, which may not be copied here. They
# are in the public repository estevaosaleme/PlaySEM_SERenderer, in resources/ of
# local-repo/lprm/mpeg-metadata/1.0.0/mpeg-metadata-1.0.0.jar. The folder needs MPEG-V-SEDL.xsd,
# MPEG-V-SEV.xsd and what they import. Two things are fixed in copies, for xmllint: the schema of
# the XML namespace, which is on a server, and a misspelled name in mpeg7-udp-2004.xsd.
# Usage: tests/tools/mpegv_schema.sh SCHEMAS FILE.sem.xml...
set -euo pipefail
[ $# -ge 2 ] && [ -f "$1/MPEG-V-SEV.xsd" ] || { sed -n '3,8s/^# \{0,1\}//p' "$0" >&2; exit 2; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$1"/*.xsd "$work"
shift
sed -i 's#schemaLocation="[^"]*xml[^"/]*\.xsd"#schemaLocation="xml-namespace.xsd"#' "$work/mpeg7-v2.xsd" "$work/mpeg7-udp-2004.xsd"
sed -i 's/xml:langt/xml:lang/' "$work/mpeg7-udp-2004.xsd"
cat >"$work/xml-namespace.xsd" <<'XSD'
<schema xmlns="http://www.w3.org/2001/XMLSchema" targetNamespace="http://www.w3.org/XML/1998/namespace">
  <attribute name="lang" type="language"/>
  <attribute name="space" type="NCName"/>
  <attribute name="base" type="anyURI"/>
</schema>
XSD
cat >"$work/all.xsd" <<'XSD'
<schema xmlns="http://www.w3.org/2001/XMLSchema">
  <import namespace="urn:mpeg:mpeg-v:2010:01-SEDL-NS" schemaLocation="MPEG-V-SEDL.xsd"/>
  <import namespace="urn:mpeg:mpeg-v:2010:01-SEV-NS" schemaLocation="MPEG-V-SEV.xsd"/>
</schema>
XSD
xmllint --noout --nonet --schema "$work/all.xsd" "$@"
