!> Runs that stay in memory, known to callers by a number.
!>
!> The pool is the only thing of Lopin that is remembered between calls. Several threads may ask for
!> runs at once; these take turns, because gfortran keeps the lengths of texts that functions return
!> in static memory (the symbols `slen` of its object files), which two runs must not share.
module lopin_session
   use lopin_deck, only : deck_type, read_deck_text
   use lopin_error, only : error_type, error_code, log_type, severity, raise
   use lopin_job_options, only : read_options
   use lopin_job, only : job_type, outcome_type, running_type, open_job, refuse_warnings, stem_of, &
      & begin_job, advance_job, job_state, forget_job, end_job
   use lopin_job_values, only : is_of_open_run, read_open_run, read_memory, job_tool_feet
   use lopin_keyword_json, only : keywords_json
   use lopin_kinds, only : wp
   use lopin_model, only : model_type
   use lopin_recorder, only : recorder_type
   use lopin_recorder_memory, only : memory_recorder_type
   use lopin_render, only : render, render_json, json_string
   use lopin_stream, only : stream_type
   implicit none
   private
   public :: session_type, deck_text_type, new_session, advance_session, end_session
   public :: session_state, session_tool_feet, forget_workspace_of
   public :: keep_session, forget_session, session_text, session_real, session_integer

   !> A deck as a caller holds it.
   type :: deck_text_type
      character(len=:), allocatable :: text
      character(len=:), allocatable :: name      !! shown in messages; its stem names the files
      character(len=:), allocatable :: folder    !! where its includes are looked for
   end type deck_text_type

   !> The run of a session. Polymorphic where it is held, so that one procedure cleans it up and not
   !> a copy of it wherever a session ends.
   type :: work_type
      type(job_type) :: job
      type(deck_type) :: deck
      type(model_type) :: model
      type(log_type) :: said                        !! so far
      type(outcome_type) :: outcome
      type(running_type) :: running                 !! until it is ended
   end type work_type

   type :: session_type
      integer :: code = 0                                    !! exit code of the executable
      character(len=:), allocatable, private :: diagnostics  !! a JSON list
      character(len=:), allocatable, private :: summary      !! a JSON object; '' before a solution
      character(len=:), allocatable, private :: names        !! of the results, one a line
      class(recorder_type), allocatable, private :: memory   !! of a run that has ended
      class(work_type), allocatable, private :: work
   end type session_type

   type :: slot_type
      type(session_type), pointer :: session => null()   !! nobody else's
   end type slot_type

   type(slot_type), allocatable :: pool(:)

   character(len=1), parameter :: nl = achar(10)

contains

   !> Read and check the deck of a session that was just allocated and, if wanted, begin its run;
   !> `state` is one to go on from.
   subroutine new_session(self, deck_text, output, options, begin, state)
      type(session_type), intent(inout) :: self
      type(deck_text_type), intent(in) :: deck_text
      character(len=*), intent(in) :: output     !! folder of the result files; '' for none
      character(len=*), intent(in) :: options    !! lines: solver=..., threads=..., strict ...
      logical, intent(in) :: begin
      type(stream_type), intent(inout), optional :: state
      type(error_type), allocatable :: error

      allocate (work_type :: self%work)
      self%summary = ''
      self%names = ''
      !$omp critical (lopin_run)
      call read_job(self, deck_text, output, options, error)
      if (begin .and. .not. allocated(error)) then
         associate (work => self%work)
            call begin_job(work%job, work%running, work%deck, work%model, work%outcome, error, &
               & state)
         end associate
         if (allocated(error)) call end_run(self, error)
      end if
      if (allocated(error)) self%code = error%code
      call tell(self, error)
      !$omp end critical (lopin_run)
   end subroutine new_session

   subroutine read_job(self, deck_text, output, options, error)
      type(session_type), intent(inout) :: self
      type(deck_text_type), intent(in) :: deck_text
      character(len=*), intent(in) :: output, options
      type(error_type), allocatable, intent(out) :: error

      call self%work%outcome%clock%start()
      call read_options(self%work%job, options, error)
      if (allocated(error)) return
      self%work%job%folder = output
      self%work%job%stem = stem_of(deck_text%name)
      self%work%job%in_memory = .true.
      call read_deck_text(self%work%deck, deck_text%text, deck_text%name, &
         & deck_text%folder, self%work%said, error)
      if (allocated(error)) return
      call open_job(self%work%job, self%work%deck, self%work%model, error)
      call add_log(self%work%said, self%work%model%log)
      if (.not. allocated(error) .and. self%work%job%strict) &
         & call refuse_warnings(self%work%said, error)
   end subroutine read_job

   !> Go to the next accepted increment of a run; at its end, or after an error, it is ended too.
   !> An interrupt ends it unless it `stays` open.
   subroutine advance_session(handle, stays, more, code)
      integer, intent(in) :: handle
      logical, intent(in) :: stays
      logical, intent(out) :: more             !! an increment was accepted
      integer, intent(out) :: code

      more = .false.
      code = error_code%usage
      if (.not. in_use(handle)) return
      !$omp critical (lopin_run)
      call advance_run_of(pool(handle)%session, stays, more, code)
      !$omp end critical (lopin_run)
   end subroutine advance_session

   subroutine advance_run_of(self, stays, more, code)
      type(session_type), intent(inout) :: self
      logical, intent(in) :: stays
      logical, intent(out) :: more
      integer, intent(out) :: code
      type(error_type), allocatable :: error
      logical :: stands

      more = .false.
      code = self%code
      if (.not. self%work%running%opened) return
      associate (work => self%work)
         call advance_job(work%job, work%running, work%model, work%outcome, more, error)
      end associate
      if (more) return
      if (allocated(error)) code = error%code
      stands = stays .and. code == error_code%interrupted
      if (stands) stands = self%work%running%run%may_step
      if (.not. stands) then
         self%code = code
         call end_run(self, error)
      end if
      call tell(self, error)
   end subroutine advance_run_of

   !> End a run where it stands; nothing happens to one that has ended.
   subroutine end_session(handle)
      integer, intent(in) :: handle
      type(error_type), allocatable :: error

      if (.not. in_use(handle)) return
      !$omp critical (lopin_run)
      associate (self => pool(handle)%session)
         if (self%work%running%opened) then
            call end_run(self, error)
            if (allocated(error)) self%code = error%code
            call tell(self, error)
         end if
      end associate
      !$omp end critical (lopin_run)
   end subroutine end_session

   subroutine end_run(self, error)
      type(session_type), intent(inout) :: self
      type(error_type), allocatable, intent(inout) :: error

      call end_job(self%work%job, self%work%running, self%work%model, self%work%outcome, error)
      call add_log(self%work%said, self%work%outcome%log)
      if (.not. allocated(self%work%outcome%recorder)) return
      associate (recorder => self%work%outcome%recorder)
         call move_alloc(recorder(size(recorder))%recorder, self%memory)
      end associate
      select type (memory => self%memory)
      type is (memory_recorder_type)
         self%names = memory%names()
         if (allocated(memory%json%content)) self%summary = memory%json%content
      end select
   end subroutine end_run

   !> What a run holds between two increments, as bytes; none if it is not open.
   subroutine session_state(handle, state)
      integer, intent(in) :: handle
      type(stream_type), intent(out) :: state
      type(error_type), allocatable :: error

      if (.not. in_use(handle)) return
      !$omp critical (lopin_run)
      associate (self => pool(handle)%session)
         if (self%work%running%opened .and. (self%work%running%run%in_step &
            & .or. self%work%running%run%scene%accepted%clock%number > 0)) &
            & call job_state(self%work%running, self%work%deck, self%work%model, state, error)
      end associate
      !$omp end critical (lopin_run)
   end subroutine session_state

   !> Closest points of the tool of a pair, of an open run; see `job_tool_feet`.
   subroutine session_tool_feet(handle, pair, points, foot, found)
      integer, intent(in) :: handle, pair
      real(wp), intent(in) :: points(:, :)       !! (ndim, n) [length]
      real(wp), intent(out) :: foot(:, :)        !! (2 + 2 ndim, n)
      logical, intent(out) :: found

      foot = 0.0_wp
      found = .false.
      if (.not. in_use(handle)) return
      associate (work => pool(handle)%session%work)
         if (allocated(pool(handle)%session%work)) call job_tool_feet(work%running, work%model, &
            & pair, points, foot, found)
      end associate
   end subroutine session_tool_feet

   !> Throw the workspace of a run away between two increments: the run goes on to the same bits.
   subroutine forget_workspace_of(handle, code)
      integer, intent(in) :: handle
      integer, intent(out) :: code
      type(error_type), allocatable :: error

      code = 0
      if (.not. in_use(handle)) return
      !$omp critical (lopin_run)
      associate (self => pool(handle)%session)
         if (self%work%running%opened) call forget_job(self%work%job, self%work%running, &
            & self%work%model, self%work%outcome, error)
         if (allocated(error)) code = error%code
         call tell(self, error)
      end associate
      !$omp end critical (lopin_run)
   end subroutine forget_workspace_of

   !> Notes and warnings; errors come by themselves.
   subroutine add_log(said, log)
      type(log_type), intent(inout) :: said
      type(log_type), intent(in) :: log
      integer :: i

      do i = 1, log%n
         associate (d => log%item(i))
            if (d%severity /= severity%error) call said%say(d%severity, d%id, d%message, d%at, &
               & d%label, d%note, d%help)
         end associate
      end do
   end subroutine add_log

   !> Everything that was said, with the text that the executable would show.
   subroutine tell(self, error)
      type(session_type), intent(inout) :: self
      type(error_type), allocatable, intent(in) :: error
      type(log_type) :: all
      character(len=:), allocatable :: one
      integer :: i

      call add_log(all, self%work%said)
      if (allocated(error)) then
         do i = 1, size(error%item)
            associate (d => error%item(i))
               call all%say(d%severity, d%id, d%message, d%at, d%label, d%note, d%help)
            end associate
         end do
      end if
      self%diagnostics = '['
      do i = 1, all%n
         one = render_json(all%item(i), self%work%deck)
         if (i > 1) self%diagnostics = self%diagnostics//','//nl
         self%diagnostics = self%diagnostics//one(:len(one) - 1)//', "text": ' &
            & //json_string(render(all%item(i), self%work%deck, .false.))//'}'
      end do
      self%diagnostics = self%diagnostics//']'
   end subroutine tell

   !> Put a session into the pool; its number is never 0.
   subroutine keep_session(session, handle)
      type(session_type), pointer, intent(in) :: session
      integer, intent(out) :: handle

      !$omp critical (lopin_pool)
      if (.not. allocated(pool)) allocate (pool(8))
      do handle = 1, size(pool)
         if (.not. associated(pool(handle)%session)) exit
      end do
      if (handle > size(pool)) call grow_pool()
      pool(handle)%session => session
      !$omp end critical (lopin_pool)
   end subroutine keep_session

   subroutine grow_pool()
      type(slot_type), allocatable :: larger(:)

      allocate (larger(2*size(pool)))
      larger(:size(pool)) = pool
      call move_alloc(larger, pool)
   end subroutine grow_pool

   !> Free what a session holds; nothing happens for a number that is not in use.
   subroutine forget_session(handle)
      integer, intent(in) :: handle

      !$omp critical (lopin_pool)
      if (in_use(handle)) deallocate (pool(handle)%session)
      !$omp end critical (lopin_pool)
   end subroutine forget_session

   pure logical function in_use(handle)
      integer, intent(in) :: handle

      in_use = .false.
      if (.not. allocated(pool)) return
      if (handle >= 1 .and. handle <= size(pool)) in_use = associated(pool(handle)%session)
   end function in_use

   !> diagnostics, summary (JSON), names (lines) of a session; keywords (JSON) of the deck language.
   subroutine session_text(handle, what, text)
      integer, intent(in) :: handle
      character(len=*), intent(in) :: what
      character(len=:), allocatable, intent(out) :: text

      text = ''
      if (what == 'keywords') then
         !$omp critical (lopin_run)
         text = keywords_json()
         !$omp end critical (lopin_run)
         return
      end if
      !$omp critical (lopin_pool)
      if (in_use(handle)) then
         if (what == 'diagnostics') text = pool(handle)%session%diagnostics
         if (what == 'summary') text = pool(handle)%session%summary
         if (what == 'names') text = names_of(pool(handle)%session)
      end if
      !$omp end critical (lopin_pool)
   end subroutine session_text

   !> A result (component, item); unallocated if there is none.
   subroutine session_real(handle, name, index, values)
      integer, intent(in) :: handle
      character(len=*), intent(in) :: name
      integer, intent(in) :: index               !! increment from 1
      real(wp), allocatable, intent(out) :: values(:, :)
      integer, allocatable :: none(:, :)

      !$omp critical (lopin_pool)
      if (in_use(handle)) call read_result(pool(handle)%session, name, index, values, none)
      !$omp end critical (lopin_pool)
   end subroutine session_real

   subroutine session_integer(handle, name, index, values)
      integer, intent(in) :: handle
      character(len=*), intent(in) :: name
      integer, intent(in) :: index               !! increment from 1
      integer, allocatable, intent(out) :: values(:, :)
      real(wp), allocatable :: none(:, :)

      !$omp critical (lopin_pool)
      if (in_use(handle)) call read_result(pool(handle)%session, name, index, none, values)
      !$omp end critical (lopin_pool)
   end subroutine session_integer

   !> Of a run that has ended, or of one that is open.
   subroutine read_result(self, name, index, reals, integers)
      type(session_type), intent(inout) :: self
      character(len=*), intent(in) :: name
      integer, intent(in) :: index               !! increment from 1
      real(wp), allocatable, intent(inout) :: reals(:, :)
      integer, allocatable, intent(inout) :: integers(:, :)

      if (is_of_open_run(name)) then
         if (allocated(self%work)) call read_open_run(self%work%running, self%work%model, name, &
            & reals)
      else if (allocated(self%memory)) then
         call read_memory(self%memory, name, index, reals, integers)
      else if (allocated(self%work%outcome%recorder)) then
         associate (recorder => self%work%outcome%recorder)
            call read_memory(recorder(size(recorder))%recorder, name, index, reals, integers)
         end associate
      end if
   end subroutine read_result

   !> Words of the results so far.
   function names_of(self) result(names)
      type(session_type), intent(in) :: self
      character(len=:), allocatable :: names

      names = self%names
      if (allocated(self%memory) .or. .not. allocated(self%work%outcome%recorder)) return
      select type (memory => self%work%outcome%recorder(size(self%work%outcome%recorder))%recorder)
      type is (memory_recorder_type)
         names = memory%names()
      end select
   end function names_of
end module lopin_session
