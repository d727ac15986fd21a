!> The main result: `job.pvd`, and for each output time a `.vtu` of the solid, of each slave surface
!> and of each tool. The `.pvd` grows with each output, and is valid while the run goes on.
module lopin_recorder_vtu
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_error, only : error_type, error_code, raise
   use lopin_stream, only : stream_type
   use lopin_model, only : model_type, output_of
   use lopin_report, only : frame_type
   use lopin_recorder, only : recorder_type, wants_type
   use lopin_atomic_file, only : read_text, remove_file, written_mark, is_foreign
   use lopin_collection_file, only : collection_file_type
   use lopin_part_names, only : part_name_type, name_parts
   use lopin_recorder_table, only : is_due, has_variable, pair_name
   use lopin_safe_text, only : xml_text, xml_meaning
   use lopin_vtu_writer, only : vtu_writer_type, vtu_cells_type
   use lopin_vtu_parts, only : surface_part_type, new_solid_cells, new_surface_part, write_solid, &
      & write_surface, write_tool
   implicit none
   private
   public :: vtu_recorder_type, new_vtu_recorder

   type, extends(recorder_type) :: vtu_recorder_type
      private
      character(len=:), allocatable :: folder, stem
      character(len=:), allocatable :: old          !! `.pvd` of an earlier run, to be replaced
      character(len=:), allocatable :: dataset      !! lines of this output
      integer :: written = 0
      type(collection_file_type) :: list
      type(part_name_type), allocatable :: pair(:), tool(:)
      type(vtu_writer_type) :: writer
      type(vtu_cells_type) :: solid
      type(surface_part_type), allocatable :: slave(:)
   contains
      procedure :: begin
      procedure :: commit
      procedure :: increment
      procedure :: close => close_list
      procedure :: keep
      procedure :: wants
   end type vtu_recorder_type

contains

   subroutine new_vtu_recorder(self, folder, stem)
      type(vtu_recorder_type), intent(out) :: self
      character(len=*), intent(in) :: folder, stem
      self%folder = folder
      self%stem = stem
   end subroutine new_vtu_recorder

   subroutine begin(self, model, error)
      class(vtu_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(error_type), allocatable, intent(out) :: error
      integer :: i

      call new_solid_cells(self%solid, model)
      if (allocated(self%slave)) deallocate (self%slave)
      allocate (self%slave(size(model%pair)))
      do i = 1, size(model%pair)
         call new_surface_part(self%slave(i), model, model%pair(i)%slave)
      end do
      call name_all(self, model)
      self%written = 0
      self%old = ''
      if (.not. self%resumes) call read_text(self%folder//'/'//self%stem//'.pvd', self%old)
      call self%list%open(self%folder//'/'//self%stem//'.pvd', error, self%resumes)
   end subroutine begin

   !> What readers show of pairs and tools, and the words of their files.
   subroutine name_all(self, model)
      type(vtu_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      integer :: i

      if (allocated(self%pair)) deallocate (self%pair, self%tool)
      allocate (self%pair(size(model%pair)), self%tool(size(model%tool)))
      do i = 1, size(model%pair)
         self%pair(i)%name = pair_name(model, i)
      end do
      do i = 1, size(model%tool)
         self%tool(i)%name = model%tool(i)%name
      end do
      call name_parts(self%pair)
      call name_parts(self%tool)
   end subroutine name_all

   subroutine commit(self, error)
      class(vtu_recorder_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error

      call self%list%commit(error)
      if (.not. allocated(error)) call remove_listed(self%folder, self%stem, self%old)
      self%old = ''
   end subroutine commit

   subroutine increment(self, model, frame, error)
      class(vtu_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      type(error_type), allocatable, intent(out) :: error
      integer :: i
      type(part_name_type) :: solid

      if (.not. is_due(frequency_of(model, frame%step), frame)) return
      self%written = self%written + 1
      self%dataset = ''
      solid%name = 'solid'
      solid%word = ''
      call write_solid(self%writer, model, self%solid, frame, shows(model, frame%step, 'U'), &
         & shows(model, frame%step, 'RF'))
      call write_part(self, solid, 0, frame%total_time, error)
      do i = 1, size(model%pair)
         if (allocated(error)) exit
         call write_surface(self%writer, model, self%slave(i), frame, frame%contact(i))
         call write_part(self, self%pair(i), i, frame%total_time, error)
      end do
      do i = 1, size(model%tool)
         if (allocated(error)) exit
         call write_tool(self%writer, model, i, frame)
         call write_part(self, self%tool(i), size(model%pair) + i, frame%total_time, error)
      end do
      if (.not. allocated(error)) call self%list%add(self%dataset, error)
      if (allocated(error)) call forget_output(self)
   end subroutine increment

   !> An output that could not be written whole leaves no file that nothing lists.
   subroutine forget_output(self)
      type(vtu_recorder_type), intent(inout) :: self

      call remove_files(self%folder, self%stem, self%dataset)
      self%written = self%written - 1
   end subroutine forget_output

   subroutine keep(self, stream, error)
      class(vtu_recorder_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      type(error_type), allocatable, intent(out) :: error

      call stream%pass(self%written)
      call self%list%keep(stream, error)
   end subroutine keep

   subroutine close_list(self, error)
      class(vtu_recorder_type), intent(inout) :: self
      type(error_type), allocatable, intent(out) :: error

      call self%list%close(error)
   end subroutine close_list

   !> The last increment of a step is always due, and is not known in advance.
   function wants(self, model, frame) result(what)
      class(vtu_recorder_type), intent(in) :: self
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      type(wants_type) :: what

      associate (unused => self)
         what%nodal_stress = is_due(frequency_of(model, frame%step), frame) &
            & .and. shows(model, frame%step, 'S')
      end associate
   end function wants

   !> Of *OUTPUT, FIELD; else of the *NODE/EL/CONTACT FILE requests; else every increment.
   pure integer function frequency_of(model, step) result(frequency)
      type(model_type), intent(in) :: model
      integer, intent(in) :: step

      associate (output => model%step(step)%output)
         if (any(output%kind == output_of%field)) then
            frequency = smallest(pack(output%frequency, output%kind == output_of%field))
         else
            frequency = smallest(pack(output%frequency, output%kind == output_of%node_file &
               & .or. output%kind == output_of%element_file &
               & .or. output%kind == output_of%contact_file))
            if (frequency == 0) frequency = 1
         end if
      end associate
   end function frequency_of

   pure integer function smallest(list)
      integer, intent(in) :: list(:)
      smallest = 0
      if (any(list > 0)) smallest = minval(list, mask=list > 0)
   end function smallest

   !> U, RF and S unless *OUTPUT, FIELD lists variables and not this one.
   pure logical function shows(model, step, word)
      type(model_type), intent(in) :: model
      integer, intent(in) :: step
      character(len=*), intent(in) :: word
      logical :: listed
      integer :: i

      listed = .false.
      shows = .false.
      associate (output => model%step(step)%output)
         do i = 1, size(output)
            if (output(i)%kind /= output_of%field) cycle
            if (size(output(i)%variable) == 0) cycle
            listed = .true.
            if (has_variable(output(i)%variable, [character(len=8) :: word, 'PRESELEC', &
               & 'ALL'])) shows = .true.
         end do
      end associate
      shows = shows .or. .not. listed
   end function shows

   !> Write what the writer holds as the next part of this output time.
   subroutine write_part(self, name, part, time, error)
      type(vtu_recorder_type), intent(inout) :: self
      type(part_name_type), intent(in) :: name
      integer, intent(in) :: part               !! 0: the solid; pairs, then tools
      real(wp), intent(in) :: time
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: file
      character(len=12) :: number

      write (number, '(i0.4)') self%written
      file = self%stem//'_'
      if (part > 0) file = file//trim(merge('contact_', 'tool_   ', part <= size(self%pair)))// &
         & name%word//'_'
      file = file//trim(number)//'.vtu'
      if (is_foreign(self%folder//'/'//file)) then
         call raise(error, error_code%resource, 'E0603', "'"//self%folder//'/'//file// &
            & "' exists and was not written by Lopin", &
            & help='choose another folder with -o, or move the file away')
         return
      end if
      call self%writer%write(self%folder//'/'//file, error)
      if (allocated(error)) return
      self%dataset = self%dataset//'<DataSet timestep="'//to_text(time)//'" group="" part="' &
         & //to_text(part)//'" name="'//xml_text(name%name)//'" file="'//xml_text(file)//'"/>'// &
         & achar(10)
   end subroutine write_part

   !> Remove the `.vtu` that an older `.pvd` of ours lists, and nothing else.
   subroutine remove_listed(folder, stem, old)
      character(len=*), intent(in) :: folder, stem, old

      if (index(old, written_mark) > 0) call remove_files(folder, stem, old)
   end subroutine remove_listed

   !> Remove the files of this job that lines of a `.pvd` name.
   subroutine remove_files(folder, stem, old)
      character(len=*), intent(in) :: folder, stem, old
      character(len=:), allocatable :: name
      integer :: first, last, from

      from = 1
      do
         first = index(old(from:), 'file="')
         if (first == 0) exit
         first = from + first + 5
         last = first + index(old(first:), '"') - 2
         if (last < first) exit
         name = xml_meaning(old(first:last))
         if (index(name, '/') == 0 .and. index(name, stem//'_') == 1) &
            & call remove_file(folder//'/'//name)
         from = last + 1
      end do
   end subroutine remove_files
end module lopin_recorder_vtu
