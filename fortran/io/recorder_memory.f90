!> Keeps the results of every increment in memory, by name, for a caller in the same process.
module lopin_recorder_memory
   use lopin_kinds, only : wp
   use lopin_text, only : parse_integer
   use lopin_error, only : error_type
   use lopin_model, only : model_type
   use lopin_state, only : frame_type, summary_type, contact_field_type
   use lopin_recorder, only : recorder_type, wants_type
   use lopin_recorder_table, only : column_type, history_columns, history_row
   implicit none
   private
   public :: memory_recorder_type, real_names, integer_names, contact_real_names, &
      & contact_integer_names

   !> Names that take an increment as index; `history` is (column, increment) and ignores it.
   character(len=*), parameter :: real_names(4) = [character(len=12) :: 'displacement', &
      & 'reaction', &
      & 'stress', 'history']
   character(len=*), parameter :: integer_names(2) = [character(len=9) :: 'step', 'increment']
   !> Behind `contact.<pair>.`
   character(len=*), parameter :: contact_real_names(8) = [character(len=8) :: 'pressure', &
      & 'gap', 'weight', &
      & 'normal', 'force', 'xi', 'u_n', 'u_t']
   character(len=*), parameter :: contact_integer_names(3) = [character(len=6) :: 'node', &
      & 'status', 'facet']

   type :: kept_type
      integer :: step = 0, increment = 0
      real(wp), allocatable :: u(:, :), rf(:, :), stress(:, :), row(:)
      type(contact_field_type), allocatable :: contact(:)
   end type kept_type

   type, extends(recorder_type) :: memory_recorder_type
      integer :: nframe = 0                            !! increments kept
      type(column_type), allocatable :: column(:)      !! names of the rows of `history`
      type(summary_type) :: summary                    !! once the run has ended
      logical :: keep_stress = .true.
      type(kept_type), allocatable, private :: kept(:)
   contains
      procedure :: begin
      procedure :: increment
      procedure :: finish
      procedure :: wants
      procedure :: get_real
      procedure :: get_integer
   end type memory_recorder_type

contains

   subroutine begin(self, model, error)
      class(memory_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error

      associate (none => error)
      end associate
      self%nframe = 0
      if (allocated(self%kept)) deallocate (self%kept)
      allocate (self%kept(16))
      call history_columns(model, self%column)
   end subroutine begin

   subroutine increment(self, model, frame, error)
      class(memory_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      type(error_type), allocatable, intent(out) :: error

      associate (none => error)
      end associate
      if (self%nframe == size(self%kept)) call grow(self%kept)
      self%nframe = self%nframe + 1
      associate (kept => self%kept(self%nframe))
         kept%step = frame%step
         kept%increment = frame%increment
         kept%u = frame%u
         kept%rf = frame%rf
         if (self%keep_stress .and. allocated(frame%nodal_stress)) kept%stress = frame%nodal_stress
         if (allocated(frame%contact)) kept%contact = frame%contact
      end associate
      call history_row(model, frame, self%kept(self%nframe)%row)
   end subroutine increment

   subroutine finish(self, model, summary, failure, error)
      class(memory_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(summary_type), intent(in) :: summary
      type(error_type), allocatable, intent(in) :: failure
      type(error_type), allocatable, intent(out) :: error

      associate (unused => model, too => failure, none => error)
      end associate
      self%summary = summary
   end subroutine finish

   function wants(self, model, step, increment) result(what)
      class(memory_recorder_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: step, increment
      type(wants_type) :: what

      associate (unused => model, also => step + increment)
         what%nodal_stress = self%keep_stress
      end associate
   end function wants

   !> A copy of an array of reals (component, item); unallocated if there is none of that name.
   subroutine get_real(self, name, index, values)
      class(memory_recorder_type), intent(in) :: self
      character(len=*), intent(in) :: name     !! displacement, ..., contact.1.pressure
      integer, intent(in) :: index             !! increment, 1..nframe
      real(wp), allocatable, intent(out) :: values(:, :)
      character(len=:), allocatable :: word
      integer :: pair, i

      if (name == 'history') then
         allocate (values(size(self%column), self%nframe))
         do i = 1, self%nframe
            values(:, i) = self%kept(i)%row
         end do
         return
      end if
      if (index < 1 .or. index > self%nframe) return
      associate (kept => self%kept(index))
         select case (name)
         case ('displacement')
            values = kept%u
         case ('reaction')
            values = kept%rf
         case ('stress')
            if (allocated(kept%stress)) values = kept%stress
         case default
            call split(name, pair, word)
            if (.not. allocated(kept%contact)) return
            if (pair < 1 .or. pair > size(kept%contact)) return
            call contact_real(kept%contact(pair), word, values)
         end select
      end associate
   end subroutine get_real

   !> A copy of a list of integers; unallocated if there is none of that name.
   subroutine get_integer(self, name, index, values)
      class(memory_recorder_type), intent(in) :: self
      character(len=*), intent(in) :: name     !! step, increment (of all), contact.1.node ...
      integer, intent(in) :: index             !! increment, 1..nframe
      integer, allocatable, intent(out) :: values(:)
      character(len=:), allocatable :: word
      integer :: pair

      if (name == 'step') then
         values = self%kept(:self%nframe)%step
         return
      else if (name == 'increment') then
         values = self%kept(:self%nframe)%increment
         return
      end if
      if (index < 1 .or. index > self%nframe) return
      associate (kept => self%kept(index))
         call split(name, pair, word)
         if (.not. allocated(kept%contact)) return
         if (pair < 1 .or. pair > size(kept%contact)) return
         select case (word)
         case ('node')
            values = kept%contact(pair)%node
         case ('status')
            values = kept%contact(pair)%status
         case ('facet')
            values = kept%contact(pair)%facet
         end select
      end associate
   end subroutine get_integer

   subroutine contact_real(field, word, values)
      type(contact_field_type), intent(in) :: field
      character(len=*), intent(in) :: word
      real(wp), allocatable, intent(out) :: values(:, :)

      select case (word)
      case ('pressure')
         values = reshape(field%pressure, [1, size(field%pressure)])
      case ('gap')
         values = reshape(field%gap, [1, size(field%gap)])
      case ('weight')
         values = reshape(field%weight, [1, size(field%weight)])
      case ('normal')
         values = field%normal
      case ('force')
         values = field%force
      case ('xi')
         values = field%xi
      case ('u_n')
         values = reshape(field%u_n, [1, size(field%u_n)])
      case ('u_t')
         values = field%u_t
      end select
   end subroutine contact_real

   !> contact.3.gap -> 3, gap; anything else -> 0.
   subroutine split(name, pair, word)
      character(len=*), intent(in) :: name
      integer, intent(out) :: pair
      character(len=:), allocatable, intent(out) :: word
      character(len=*), parameter :: prefix = 'contact.'
      integer :: dot
      logical :: ok

      pair = 0
      word = ''
      if (index(name, prefix) /= 1) return
      dot = index(name, '.', back=.true.)
      if (dot <= len(prefix)) return
      call parse_integer(name(len(prefix) + 1:dot - 1), pair, ok)
      if (.not. ok) pair = 0
      word = trim(name(dot + 1:))
   end subroutine split

   !> Twice the room; the arrays themselves are moved, not copied.
   subroutine grow(kept)
      type(kept_type), allocatable, intent(inout) :: kept(:)
      type(kept_type), allocatable :: larger(:)
      integer :: i

      allocate (larger(2*size(kept)))
      do i = 1, size(kept)
         larger(i)%step = kept(i)%step
         larger(i)%increment = kept(i)%increment
         call move_alloc(kept(i)%u, larger(i)%u)
         call move_alloc(kept(i)%rf, larger(i)%rf)
         call move_alloc(kept(i)%stress, larger(i)%stress)
         call move_alloc(kept(i)%row, larger(i)%row)
         call move_alloc(kept(i)%contact, larger(i)%contact)
      end do
      call move_alloc(larger, kept)
   end subroutine grow
end module lopin_recorder_memory
