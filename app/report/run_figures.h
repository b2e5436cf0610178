#pragma once
/// What a report says of a recording: its numbers, tables and charts, gathered frame by frame in memory that
/// does not grow with the run.

#include <memory>
#include <string>
#include <vector>

#include "app/report/svg_panel.h"
#include "tactum/recording/recording_visitor.h"

namespace tactum {

/// A number of the run. Its key is its name for machines, and ends in the unit of `value`; people see the
/// value times `scale`.
struct Quantity {
  std::string section;  ///< under which the page lists it
  std::string key;      ///< "largest_sent_force_N"
  std::string label;    ///< "largest force sent"
  double value = 0.0;   ///< SI, exactly as computed from the recording
  std::string unit;     ///< of the scaled number
  double scale = 1.0;
};

/// A table with a heading for each column; cells are texts.
struct FigureTable {
  std::string title;
  std::vector<std::string> heads;
  std::vector<std::vector<std::string>> rows;
};

struct RunFigures {
  std::string file;
  RunHead head;
  McapEnd end;  ///< how the recording ended
  std::vector<Quantity> quantities;
  std::vector<Panel> panels;  ///< the same for every recording, in the same order
  std::vector<FigureTable> tables;
  std::vector<std::string> notes;  ///< what a reader must know, as sentences
};

/// The places of the columns of a frame, by name. A name that is not there is remembered, and its place is 0.
class FrameColumns {
 public:
  explicit FrameColumns(const std::vector<TraceColumn>& columns) : columns_(columns) {}
  std::size_t operator()(const std::string& name);
  /// The first name that is not there; empty when all are.
  const std::string& missing() const noexcept { return missing_; }

 private:
  const std::vector<TraceColumn>& columns_;
  std::string missing_;
};

/// A frame as figures take it in.
struct FrameNumbers {
  const RecordedInput& input;
  const std::vector<double>& row;
  double time_s;
  double number(std::size_t column) const { return row[column]; }
  Vec3 vector(std::size_t column) const { return vector_at(row, static_cast<int>(column)); }
};

/// Gathers figures of one kind.
class FigureMaker {
 public:
  virtual ~FigureMaker() = default;
  virtual void frame(const FrameNumbers& frame) = 0;
  /// Contact points of the frame that came last.
  virtual void contacts(const RecordedContacts&) {}
  virtual void finish(RunFigures& figures) const = 0;

 protected:
  FigureMaker() = default;
  FigureMaker(const FigureMaker&) = default;
  FigureMaker& operator=(const FigureMaker&) = default;
};

using FigureMakers = std::vector<std::unique_ptr<FigureMaker>>;
void add_force_figures(FigureMakers& makers, FrameColumns& columns);
void add_contact_figures(FigureMakers& makers, FrameColumns& columns, const std::vector<std::string>& bodies);
void add_energy_figures(FigureMakers& makers, FrameColumns& columns);
void add_time_figures(FigureMakers& makers, FrameColumns& columns);
void add_safety_figures(FigureMakers& makers, FrameColumns& columns);

/// Reads a recording to its end. An error where nothing can be told of it; a recording that was cut is told
/// as far as it goes. `name` is the file's.
Result<RunFigures> figures_of(const McapSource& source, const std::string& name);

/// A band of a panel from a series, every value times `scale`.
class BoundedSeries;
PanelBand band_of(const std::string& legend, const BoundedSeries& series, double scale = 1.0);

}  // namespace tactum
