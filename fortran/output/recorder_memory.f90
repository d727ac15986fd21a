!> Keeps the results of every increment in memory, by name, for a caller in the same process.
!>
!> Names: TIME; U, RF, S, Mises, LABEL at the nodes; PAIR:WORD at the slave points of a pair;
!> history.COLUMN; MESH.points and MESH.CELL. Vectors have as many components as the space.
module lopin_recorder_memory
   use lopin_kinds, only : wp
   use lopin_cells, only : cell_names, ncell
   use lopin_element_type, only : element_type, new_element_type
   use lopin_error, only : error_type
   use lopin_model, only : model_type
   use lopin_report, only : frame_type, summary_type, contact_field_type, damage_field_type
   use lopin_recorder, only : recorder_type, wants_type
   use lopin_recorder_json, only : json_recorder_type, new_json_recorder
   use lopin_recorder_table, only : column_type, history_columns, history_row, pair_name
   use lopin_vtu_parts, only : mises
   implicit none
   private
   public :: memory_recorder_type, new_memory_recorder

   character(len=1), parameter :: nl = achar(10)
   character(len=*), parameter :: contact_words = 'CPRESS COPEN WEIGHT u_n FORCE R_n R_t u_t '// &
      & 'NORMAL X XI SLIP_PATH FRICTION_WORK CSTATUS FACET LABEL'

   type :: kept_type
      real(wp) :: time = 0.0_wp
      real(wp), allocatable :: u(:, :), rf(:, :), stress(:, :), plastic(:, :), row(:)
      type(damage_field_type), allocatable :: damage(:)
      type(contact_field_type), allocatable :: contact(:)
   end type kept_type

   type :: cells_type
      integer, allocatable :: node(:, :)               !! (nnode, ncell) 1-based, Abaqus' order
   end type cells_type

   type :: name_type
      character(len=:), allocatable :: text
   end type name_type

   type, extends(recorder_type) :: memory_recorder_type
      integer :: nframe = 0                            !! increments kept
      type(json_recorder_type) :: json                 !! the summary as text
      logical :: keep_stress = .true.
      type(kept_type), allocatable, private :: kept(:)
      type(column_type), allocatable, private :: column(:)
      type(name_type), allocatable, private :: pair(:)
      type(cells_type), private :: cells(ncell)
      real(wp), allocatable, private :: x(:, :)        !! (ndim, nnode)
      integer, allocatable, private :: label(:)        !! (nnode)
   contains
      procedure :: begin
      procedure :: increment
      procedure :: finish
      procedure :: wants
      procedure :: names
      procedure :: get_real
      procedure :: get_integer
   end type memory_recorder_type

contains

   subroutine new_memory_recorder(self, deck_file)
      type(memory_recorder_type), intent(out) :: self
      character(len=*), intent(in), optional :: deck_file(:)   !! by file index of locations
      character(len=1) :: none(0)
      call new_json_recorder(self%json, '', none, deck_file)
   end subroutine new_memory_recorder

   subroutine begin(self, model, error)
      class(memory_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      self%nframe = 0
      if (allocated(self%kept)) deallocate (self%kept)
      if (allocated(self%pair)) deallocate (self%pair)
      allocate (self%kept(16), self%pair(size(model%pair)))
      do i = 1, size(model%pair)
         self%pair(i)%text = pair_name(model, i)
      end do
      self%x = model%mesh%x
      self%label = model%mesh%node_label
      call copy_cells(self, model)
      call history_columns(model, self%column)
      call self%json%begin(model, error)
   end subroutine begin

   !> The elements by their cells, rigid ones too.
   subroutine copy_cells(self, model)
      class(memory_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(element_type) :: element
      integer :: id_of(size(model%element_word)), nnode(ncell), n(ncell), i, id
      logical :: found

      nnode = 0
      do i = 1, size(id_of)
         call new_element_type(element, trim(model%element_word(i)), '', found)
         id_of(i) = element%cell%id
         nnode(id_of(i)) = element%cell%nnode
      end do
      do id = 1, ncell
         if (allocated(self%cells(id)%node)) deallocate (self%cells(id)%node)
         allocate (self%cells(id)%node(nnode(id), count(id_of(model%mesh%etype) == id)))
      end do
      n = 0
      do i = 1, model%mesh%nelement
         id = id_of(model%mesh%etype(i))
         n(id) = n(id) + 1
         self%cells(id)%node(:, n(id)) = model%mesh%conn(:nnode(id), i)
      end do
   end subroutine copy_cells

   subroutine increment(self, model, frame, error)
      class(memory_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      type(error_type), allocatable, intent(out) :: error

      if (self%nframe == size(self%kept)) call grow(self%kept)
      self%nframe = self%nframe + 1
      associate (kept => self%kept(self%nframe))
         kept%time = frame%total_time
         kept%u = frame%u(:model%mesh%ndim, :)
         kept%rf = frame%rf(:model%mesh%ndim, :)
         if (self%keep_stress .and. allocated(frame%nodal_stress)) kept%stress = frame%nodal_stress
         if (self%keep_stress .and. allocated(frame%nodal_plastic)) &
            & kept%plastic = frame%nodal_plastic
         if (self%keep_stress .and. allocated(frame%damage)) kept%damage = frame%damage
         if (allocated(frame%contact)) kept%contact = frame%contact
      end associate
      call history_row(model, frame, self%kept(self%nframe)%row)
      call self%json%increment(model, frame, error)
   end subroutine increment

   subroutine finish(self, model, summary, failure, error)
      class(memory_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(summary_type), intent(in) :: summary
      type(error_type), allocatable, intent(in) :: failure
      type(error_type), allocatable, intent(out) :: error
      call self%json%finish(model, summary, failure, error)
   end subroutine finish

   function wants(self, model, frame) result(what)
      class(memory_recorder_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      type(wants_type) :: what

      associate (unused => model, also => frame)
         what%nodal_stress = self%keep_stress
      end associate
   end function wants

   !> Every name, one a line.
   function names(self) result(text)
      class(memory_recorder_type), intent(in) :: self
      character(len=:), allocatable :: text
      integer :: i

      text = ''
      if (.not. allocated(self%kept)) return
      text = 'TIME'//nl//'U'//nl//'RF'//nl//'LABEL'//nl//'MESH.points'
      if (allocated(self%kept(1)%stress)) text = text//nl//'S'//nl//'Mises'
      if (allocated(self%kept(1)%plastic)) text = text//nl//'PEEQ'
      if (allocated(self%kept(1)%damage)) then
         do i = 1, size(self%kept(1)%damage)
            text = text//nl//'DAMAGE_'//self%kept(1)%damage(i)%name
            if (self%kept(1)%damage(i)%averaged) text = text//nl//'DAMAGE_' &
               & //self%kept(1)%damage(i)%name//'_MEAN'
         end do
      end if
      do i = 1, ncell
         if (size(self%cells(i)%node) > 0) text = text//nl//'MESH.'//trim(cell_names(i))
      end do
      do i = 1, size(self%column)
         text = text//nl//'history.'//self%column(i)%name
      end do
      do i = 1, size(self%pair)
         call add_pair(self%pair(i)%text)
      end do
   contains
      subroutine add_pair(pair)
         character(len=*), intent(in) :: pair
         integer :: first, length

         first = 1
         do while (first <= len(contact_words))
            length = index(contact_words(first:)//' ', ' ') - 1
            text = text//nl//pair//':'//contact_words(first:first + length - 1)
            first = first + length + 1
         end do
      end subroutine add_pair
   end function names

   !> A copy of an array of reals (component, item); unallocated if there is none of that name.
   subroutine get_real(self, name, index, values)
      class(memory_recorder_type), intent(in) :: self
      character(len=*), intent(in) :: name
      integer, intent(in) :: index             !! increment, 1..nframe; 0 for the whole run
      real(wp), allocatable, intent(out) :: values(:, :)
      character(len=:), allocatable :: word
      integer :: pair

      if (.not. allocated(self%kept)) return
      if (name == 'TIME') then
         values = reshape(self%kept(:self%nframe)%time, [1, self%nframe])
      else if (name == 'MESH.points') then
         values = self%x
      else if (starts(name, 'history.')) then
         call get_column(self, name(9:), values)
      end if
      if (allocated(values) .or. index < 1 .or. index > self%nframe) return
      associate (kept => self%kept(index))
         select case (name)
         case ('U')
            values = kept%u
         case ('RF')
            values = kept%rf
         case ('S')
            if (allocated(kept%stress)) values = kept%stress
         case ('Mises')
            if (allocated(kept%stress)) values = mises(kept%stress)
         case ('PEEQ')
            if (allocated(kept%plastic)) values = kept%plastic
         case default
            if (starts(name, 'DAMAGE_') .and. allocated(kept%damage)) &
               & call get_damage(kept%damage, name(8:), values)
            if (allocated(values)) return
            call find_pair(self, name, pair, word)
            if (pair > 0) call contact_real(self, kept%contact(pair), word, values)
         end select
      end associate
   end subroutine get_real

   !> Damage at the nodes by the name of its criterion, or its mean.
   subroutine get_damage(damage, name, values)
      type(damage_field_type), intent(in) :: damage(:)
      character(len=*), intent(in) :: name
      real(wp), allocatable, intent(out) :: values(:, :)
      integer :: k

      do k = 1, size(damage)
         if (.not. allocated(damage(k)%nodal)) cycle
         if (name == damage(k)%name) values = damage(k)%nodal(:1, :)
         if (name == damage(k)%name//'_MEAN') values = damage(k)%nodal(2:, :)
      end do
   end subroutine get_damage

   subroutine get_column(self, name, values)
      class(memory_recorder_type), intent(in) :: self
      character(len=*), intent(in) :: name
      real(wp), allocatable, intent(out) :: values(:, :)
      integer :: i, k

      do k = 1, size(self%column)
         if (self%column(k)%name /= name) cycle
         allocate (values(1, self%nframe))
         do i = 1, self%nframe
            values(1, i) = self%kept(i)%row(k)
         end do
         return
      end do
   end subroutine get_column

   !> A copy of integers (component, item); unallocated if there are none of that name.
   subroutine get_integer(self, name, index, values)
      class(memory_recorder_type), intent(in) :: self
      character(len=*), intent(in) :: name
      integer, intent(in) :: index             !! increment, 1..nframe; 0 for the whole run
      integer, allocatable, intent(out) :: values(:, :)
      character(len=:), allocatable :: word
      integer :: pair, i

      if (.not. allocated(self%kept)) return
      if (name == 'LABEL') values = reshape(self%label, [1, size(self%label)])
      do i = 1, ncell
         if (name == 'MESH.'//trim(cell_names(i))) values = self%cells(i)%node
      end do
      if (allocated(values) .or. index < 1 .or. index > self%nframe) return
      call find_pair(self, name, pair, word)
      if (pair == 0) return
      associate (field => self%kept(index)%contact(pair))
         select case (word)
         case ('CSTATUS')
            values = reshape(field%status, [1, size(field%status)])
         case ('FACET')
            values = reshape(field%facet, [1, size(field%facet)])
         case ('LABEL')
            values = reshape(self%label(field%node), [1, size(field%node)])
         end select
      end associate
   end subroutine get_integer

   subroutine contact_real(self, field, word, values)
      class(memory_recorder_type), intent(in) :: self
      type(contact_field_type), intent(in) :: field
      character(len=*), intent(in) :: word
      real(wp), allocatable, intent(out) :: values(:, :)

      select case (word)
      case ('CPRESS')
         values = reshape(field%pressure, [1, size(field%pressure)])
      case ('COPEN')
         values = reshape(field%gap, [1, size(field%gap)])
      case ('WEIGHT')
         values = reshape(field%weight, [1, size(field%weight)])
      case ('u_n')
         values = reshape(field%u_n, [1, size(field%u_n)])
      case ('NORMAL')
         values = field%normal
      case ('FORCE')
         values = field%force
      case ('R_n')
         values = field%force - field%shear
      case ('R_t')
         values = field%shear
      case ('SLIP_PATH')
         allocate (values(1, size(field%node)), source=0.0_wp)
         if (allocated(field%slip_path)) values = reshape(field%slip_path, [1, size(field%node)])
      case ('FRICTION_WORK')
         allocate (values(1, size(field%node)), source=0.0_wp)
         if (allocated(field%friction_work)) values = reshape(field%friction_work, &
            & [1, size(field%node)])
      case ('u_t')
         values = field%u_t
      case ('XI')
         values = field%xi
      case ('X')
         values = self%x(:, field%node)
      end select
   end subroutine contact_real

   !> TOP-BALL:CPRESS -> the number of that pair, CPRESS; anything else -> 0.
   subroutine find_pair(self, name, pair, word)
      class(memory_recorder_type), intent(in) :: self
      character(len=*), intent(in) :: name
      integer, intent(out) :: pair
      character(len=:), allocatable, intent(out) :: word
      integer :: colon

      colon = index(name, ':', back=.true.)
      word = name(colon + 1:)
      do pair = size(self%pair), 1, -1
         if (self%pair(pair)%text//':' == name(:colon)) return
      end do
   end subroutine find_pair

   pure logical function starts(text, prefix)
      character(len=*), intent(in) :: text, prefix
      starts = index(text, prefix) == 1
   end function starts

   !> Twice the room; the arrays themselves are moved, not copied.
   subroutine grow(kept)
      type(kept_type), allocatable, intent(inout) :: kept(:)
      type(kept_type), allocatable :: larger(:)
      integer :: i

      allocate (larger(2*size(kept)))
      do i = 1, size(kept)
         larger(i)%time = kept(i)%time
         call move_alloc(kept(i)%u, larger(i)%u)
         call move_alloc(kept(i)%rf, larger(i)%rf)
         call move_alloc(kept(i)%stress, larger(i)%stress)
         call move_alloc(kept(i)%plastic, larger(i)%plastic)
         call move_alloc(kept(i)%row, larger(i)%row)
         call move_alloc(kept(i)%damage, larger(i)%damage)
         call move_alloc(kept(i)%contact, larger(i)%contact)
      end do
      call move_alloc(larger, kept)
   end subroutine grow
end module lopin_recorder_memory
