!> `job.json`: what a run did, for programs. Written at the start with status `running`, and at the
!> end; without a path the text is only kept.
module lopin_recorder_json
   use, intrinsic :: iso_c_binding, only : c_null_char, c_int
   use lopin_kinds, only : wp, lk
   use lopin_clock, only : phase_names, nphase, counter_type
   use lopin_error, only : error_type, error_code, diagnostic_type
   use lopin_stream, only : stream_type
   use lopin_model, only : model_type, kind_of
   use lopin_report, only : frame_type, summary_type
   use lopin_settings, only : settings_type
   use lopin_recorder, only : recorder_type
   use lopin_atomic_file, only : write_atomically, remove_file
   use lopin_checked_file, only : summary_is, summary_failed
   use lopin_json_writer, only : json_writer_type
   use lopin_json_verdict, only : verdict_type, note_verdict, keep_verdict, add_judgement
   use lopin_version, only : version
   use lopin_pair_peak, only : pair_peak_type, note_peak, keep_peak, add_peak, pair_words
   use lopin_recorder_table, only : pair_summary_type, summarise_pair, pair_name
   implicit none
   private
   public :: json_recorder_type, new_json_recorder, json_schema, only_asked

   character(len=*), parameter :: json_schema = 'lopin-result/1'
   !> Files that a run writes only if its deck asks for them.
   character(len=*), parameter :: only_asked(2) = ['.dat', '.frd']
   character(len=*), parameter :: kind_words(5) = [character(len=12) :: 'plane strain', &
      & 'plane stress', &
      & 'axisymmetric', 'solid', 'rigid']
   character(len=*), parameter :: severity_words(0:2) = [character(len=7) :: 'note', 'warning', &
      & 'error']

   !> `file` and `deck_file` are plain names; the last accepted increment is kept for the end.
   type, extends(recorder_type) :: json_recorder_type
      character(len=:), allocatable :: content   !! the whole text, once the run has ended
      character(len=:), allocatable, private :: path
      character(len=:), allocatable, private :: file(:)        !! what the run writes
      character(len=:), allocatable, private :: deck_file(:)   !! by file index of locations
      type(pair_summary_type), allocatable, private :: pair(:)
      type(pair_peak_type), allocatable, private :: peak(:)
      real(wp), allocatable, private :: lost(:)  !! by pair, worst: contact_field_type
      type(verdict_type) :: judgement
      logical, private :: has_frame = .false.
      logical, private :: stale(size(only_asked)) = .false.   !! of an earlier run, not of this
   contains
      procedure :: begin
      procedure :: commit
      procedure :: increment
      procedure :: finish
      procedure :: keep
      procedure :: told
   end type json_recorder_type

contains

   subroutine new_json_recorder(self, path, file, deck_file, stale)
      type(json_recorder_type), intent(out) :: self
      character(len=*), intent(in) :: path            !! '': no file, the text is kept only
      character(len=*), intent(in) :: file(:)
      character(len=*), intent(in), optional :: deck_file(:)   !! by file index of locations
      logical, intent(in), optional :: stale(:)   !! files of an earlier run, by `only_asked`

      self%path = path
      if (present(stale)) self%stale = stale
      allocate (character(len=len(file)) :: self%file(size(file)))
      self%file(:) = file
      if (present(deck_file)) then
         allocate (character(len=len(deck_file)) :: self%deck_file(size(deck_file)))
         self%deck_file(:) = deck_file
      else
         allocate (character(len=1) :: self%deck_file(0))
      end if
   end subroutine new_json_recorder

   subroutine begin(self, model, error)
      class(json_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error

      associate (none => error)
      end associate
      if (allocated(self%pair)) deallocate (self%pair, self%peak)
      allocate (self%pair(size(model%pair)), self%peak(size(model%pair)))
      self%lost = spread(0.0_wp, 1, size(model%pair))
      self%has_frame = .false.
   end subroutine begin

   !> From now on the folder is of this run.
   subroutine commit(self, error)
      class(json_recorder_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      if (len(self%path) == 0) return
      do i = 1, size(only_asked)
         if (self%stale(i)) call remove_file(self%path(:len(self%path) - len('.json'))// &
            & only_asked(i))
      end do
      ! Room for `failed`, where a full disk takes nothing longer.
      call write_atomically(self%path, short_text(self, 'running')//repeat(' ', 64)//achar(10), &
         & error)
      if (.not. allocated(error)) call summary_is(self%path//c_null_char, &
         & short_text(self, 'failed')//c_null_char)
   end subroutine commit

   !> What a run without an end is: its status and its files.
   function short_text(self, status) result(text)
      type(json_recorder_type), intent(in) :: self
      character(len=*), intent(in) :: status
      character(len=:), allocatable :: text
      type(json_writer_type) :: json

      call json%open('{', '')
      call json%add('schema', json_schema)
      call json%add('status', status)
      if (status /= 'running') call json%add('exit_code', error_code%resource)
      call add_list(json, 'files', self%file)
      call json%close('}')
      text = json%text%content()
   end function short_text

   subroutine increment(self, model, frame, error)
      class(json_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      associate (unused => model, none => error)
      end associate
      self%has_frame = .true.
      call note_verdict(self%judgement, frame)
      do i = 1, size(self%pair)
         call summarise_pair(frame%contact(i), self%pair(i))
         call note_peak(self%peak(i), self%pair(i), frame)
         self%lost(i) = max(self%lost(i), frame%contact(i)%lost)
      end do
   end subroutine increment

   subroutine keep(self, stream, error)
      class(json_recorder_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      associate (none => error)
      end associate
      call stream%pass(self%has_frame)
      call keep_verdict(self%judgement, stream)
      do i = 1, size(self%pair)
         associate (pair => self%pair(i))
            call stream%pass_within(pair%force)
            call stream%pass(pair%area)
            call stream%pass(pair%max_pressure)
            call stream%pass(pair%max_penetration)
            call stream%pass(pair%closed)
            call stream%pass(pair%sticking)
            call stream%pass(self%lost(i))
            call keep_peak(self%peak(i), stream)
         end associate
      end do
   end subroutine keep

   subroutine finish(self, model, summary, failure, error)
      class(json_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(summary_type), intent(in) :: summary
      type(error_type), allocatable, intent(in) :: failure
      type(error_type), allocatable, intent(out) :: error
      type(json_writer_type) :: json

      call json%open('{', '')
      call json%add('schema', json_schema)
      call json%add('version', version)
      if (size(self%deck_file) > 0) call json%add('deck', trim(self%deck_file(1)))
      call json%add('status', summary%status)
      call json%add('exit_code', summary%exit_code)
      call add_model(json, model)
      call add_run(json, summary)
      call add_contact(self, json, model)
      if (self%has_frame) then
         call add_judgement(self%judgement, json)
      else
         call json%null('certificate')
         call json%null('energy')
      end if
      call add_timing(json, summary)
      call add_list(json, 'files', self%file)
      call add_diagnostics(self, json, model, summary, failure)
      call json%close('}')
      self%content = json%text%content()
      if (len(self%path) == 0) return
      call write_atomically(self%path, self%content, error, lasting=.true.)
      if (allocated(error)) call summary_failed(int(error_code%resource, c_int))
      call summary_is(c_null_char, c_null_char)
   end subroutine finish

   !> A few words on one pair at the end, for people: "TOP-BALL: 25 points in contact, ...".
   function told(self, model, i) result(text)
      class(json_recorder_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: i            !! number of the pair
      character(len=:), allocatable :: text

      text = pair_name(model, i)//': no increment'
      if (self%has_frame) text = pair_name(model, i)//': '// &
         & pair_words(self%peak(i), self%pair(i), model%mesh%ndim)
   end function told

   subroutine add_model(json, model)
      type(json_writer_type), intent(inout) :: json
      type(model_type), intent(in) :: model

      call json%add('heading', model%heading)
      if (model%settings%count_all() > 0) call add_settings(json, model%settings)
      call json%open('{', 'model')
      call json%add('kind', trim(kind_words(max(1, min(5, model%kind)))))
      call json%add('dimensions', model%mesh%ndim)
      call json%add('nodes', model%mesh%nnode)
      call json%add('elements', model%mesh%nelement)
      call json%close('}')
      if (model%kind == kind_of%axisymmetric) call json%add('forces', 'full circumference')
   end subroutine add_model

   subroutine add_settings(json, settings)
      type(json_writer_type), intent(inout) :: json
      type(settings_type), intent(in) :: settings
      integer :: i

      call json%open('{', 'settings')
      do i = 1, settings%count_all()
         associate (setting => settings%item(i))
            if (setting%is_number) call json%add(setting%name, setting%value)
            if (.not. setting%is_number) call json%add(setting%name, setting%text)
         end associate
      end do
      call json%close('}')
   end subroutine add_settings

   subroutine add_run(json, summary)
      type(json_writer_type), intent(inout) :: json
      type(summary_type), intent(in) :: summary
      integer :: i

      call json%add('plan', summary%plan)
      call json%add('path', summary%path)
      call json%add('solver', summary%solver)
      call json%add('equations', summary%equations)
      call json%add('retained', summary%retained)
      call json%add('candidates', summary%candidates)
      call json%open('[', 'steps')
      if (allocated(summary%step)) then
         do i = 1, size(summary%step)
            associate (step => summary%step(i))
               call json%open('{', '')
               call json%add('increments', step%increments)
               call json%add('iterations', step%counter%iterations)
               call json%add('factorisations', step%counter%factorisations)
               call json%add('back_solves', step%counter%back_solves)
               call json%add('augmentations', step%counter%augmentations)
               if (summary%path == 'finite') call add_search(json, step%counter)
               call json%close('}')
            end associate
         end do
      end if
      call json%close(']')
   end subroutine add_run

   !> What the contacts of the nonlinear path asked in a step.
   subroutine add_search(json, counter)
      type(json_writer_type), intent(inout) :: json
      type(counter_type), intent(in) :: counter

      call json%open('{', 'search')
      call json%add('queries', within(counter%queries))
      call json%add('projections', within(counter%projections))
      call json%add('boxes', within(counter%boxes))
      call json%close('}')

   contains

      pure integer function within(many)
         integer(lk), intent(in) :: many
         within = int(min(many, int(huge(1), lk)))
      end function within
   end subroutine add_search

   subroutine add_contact(self, json, model)
      type(json_recorder_type), intent(in) :: self
      type(json_writer_type), intent(inout) :: json
      type(model_type), intent(in) :: model
      integer :: i

      call json%open('[', 'contact')
      do i = 1, size(model%pair)
         call json%open('{', '')
         call json%add('pair', pair_name(model, i))
         call json%add('slave', model%surface(model%pair(i)%slave)%name)
         if (model%pair(i)%master > 0) call json%add('master', &
            & model%surface(model%pair(i)%master)%name)
         if (model%pair(i)%interaction > 0) call json%add('method', &
            & model%interaction(model%pair(i)%interaction)%method%word())
         if (self%has_frame) then
            call json%add('force', self%pair(i)%force(:model%mesh%ndim))
            call json%add('area', self%pair(i)%area)
            call json%add('max_pressure', self%pair(i)%max_pressure)
            call json%add('max_penetration', self%pair(i)%max_penetration)
            call json%add('closed', self%pair(i)%closed)
            call json%add('sticking', self%pair(i)%sticking)
            call json%add('traction', self%lost(i))
            call add_peak(self%peak(i), json)
         end if
         call json%close('}')
      end do
      call json%close(']')
   end subroutine add_contact

   subroutine add_timing(json, summary)
      type(json_writer_type), intent(inout) :: json
      type(summary_type), intent(in) :: summary
      integer :: i

      call json%open('{', 'timing')
      do i = 1, nphase
         call json%add(trim(phase_names(i)), summary%clock%seconds(i))
      end do
      call json%add('total', summary%clock%total())
      call json%close('}')
      call json%add('peak_memory_mib', summary%peak_memory)
      call json%add('threads', summary%threads)
      call json%add('checksum', summary%checksum)
   end subroutine add_timing

   subroutine add_diagnostics(self, json, model, summary, failure)
      type(json_recorder_type), intent(in) :: self
      type(json_writer_type), intent(inout) :: json
      type(model_type), intent(in) :: model
      type(summary_type), intent(in) :: summary
      type(error_type), allocatable, intent(in) :: failure
      integer :: i

      call json%open('[', 'diagnostics')
      do i = 1, model%log%n
         call add_diagnostic(self, json, model%log%item(i))
      end do
      do i = 1, summary%log%n
         call add_diagnostic(self, json, summary%log%item(i))
      end do
      if (allocated(failure)) then
         if (allocated(failure%item)) then
            do i = 1, size(failure%item)
               call add_diagnostic(self, json, failure%item(i))
            end do
         end if
      end if
      call json%close(']')
   end subroutine add_diagnostics

   subroutine add_diagnostic(self, json, item)
      type(json_recorder_type), intent(in) :: self
      type(json_writer_type), intent(inout) :: json
      type(diagnostic_type), intent(in) :: item

      call json%open('{', '')
      call json%add('code', item%id)
      call json%add('severity', trim(severity_words(item%severity)))
      call json%add('message', item%message)
      if (item%at%file >= 1 .and. item%at%file <= size(self%deck_file)) then
         call json%add('file', trim(self%deck_file(item%at%file)))
      else
         call json%null('file')
      end if
      if (item%at%line > 0) then
         call json%add('line', item%at%line)
         call json%add('column', item%at%first)
      else
         call json%null('line')
         call json%null('column')
      end if
      call json%add('help', item%help)
      call json%close('}')
   end subroutine add_diagnostic

   subroutine add_list(json, name, list)
      type(json_writer_type), intent(inout) :: json
      character(len=*), intent(in) :: name, list(:)
      integer :: i

      call json%open('[', name)
      do i = 1, size(list)
         call json%add('', trim(list(i)))
      end do
      call json%close(']')
   end subroutine add_list
end module lopin_recorder_json
