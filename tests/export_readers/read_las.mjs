// Prints what copc's reader of LAS finds in a file, as JSON: header, records and points.
import { readFileSync } from "node:fs";
import { Las } from "copc";

const bytes = readFileSync(process.argv[2]);
const get = async (begin, end) => bytes.subarray(begin, end);
const header = Las.Header.parse(bytes.subarray(0, 375));
const records = await Las.Vlr.walk(get, header);
const content = (user, id) => {
  const record = Las.Vlr.find(records, user, id);
  return record && bytes.subarray(record.contentOffset, record.contentOffset + record.contentLength);
};
const wkt = content("LASF_Projection", 2112);
const extra = content("LASF_Spec", 4);
const attributes = extra ? Las.ExtraBytes.parse(extra) : [];
const end = header.pointDataOffset + header.pointCount * header.pointDataRecordLength;
const view = Las.View.create(bytes.subarray(header.pointDataOffset, end), header, attributes);
const names = ["X", "Y", "Z", "Red", "Green", "Blue", "ReturnNumber", "NumberOfReturns",
               ...attributes.map((attribute) => attribute.name)];
const points = {};
for (const name of names) {
  const getter = view.getter(name);
  points[name] = Array.from({ length: view.pointCount }, (_, index) => getter(index));
}
const wktText = wkt ? wkt.toString("latin1").replace(/\0$/, "") : "";
console.log(JSON.stringify({ header, wkt: wktText, points, size: bytes.length, end }));
