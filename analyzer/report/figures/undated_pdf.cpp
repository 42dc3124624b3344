#include "analyzer/report/figures/undated_pdf.hpp"

#include <fmt/format.h>

#include <memory>
#include <qpdf/Buffer.hh>
#include <qpdf/QPDF.hh>
#include <qpdf/QPDFExc.hh>
#include <qpdf/QPDFObjectHandle.hh>
#include <qpdf/QPDFWriter.hh>

#include "analyzer/report_error.hpp"

namespace lab::report {

std::string undatedPdf(const std::string& pdf) {
  try {
    QPDF file;
    file.setSuppressWarnings(true);
    file.setAttemptRecovery(false);
    file.processMemoryFile("figure.pdf", pdf.data(), pdf.size());
    QPDFObjectHandle info = file.getTrailer().getKey("/Info");
    if (info.isDictionary()) info.removeKey("/CreationDate");

    QPDFWriter writer(file);
    writer.setOutputMemory();
    // Objects readable as text. (cairo 1.18 compresses several together.)
    writer.setObjectStreamMode(qpdf_o_disable);
    writer.setDeterministicID(true);  // from the contents, not from time and file name
    writer.write();
    const std::shared_ptr<Buffer> bytes = writer.getBufferSharedPointer();
    return std::string(reinterpret_cast<const char*>(bytes->getBuffer()), bytes->getSize());
  } catch (const QPDFExc& error) {
    throw ReportError(
        fmt::format("gnuplot wrote a figure that is not a complete PDF: {}", error.what()));
  }
}

}  // namespace lab::report
