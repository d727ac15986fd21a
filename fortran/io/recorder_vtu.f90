!> The main result: `job.pvd`, and for each output time a `.vtu` of the solid, of each slave surface
!> and of each tool. The `.pvd` is rewritten after each output, so it is valid while the run goes
!> on.
module lopin_recorder_vtu
   use lopin_kinds, only : wp
   use lopin_text, only : to_text
   use lopin_error, only : error_type, error_code, raise
   use lopin_stream, only : stream_type
   use lopin_model, only : model_type, output_of
   use lopin_state, only : frame_type, summary_type
   use lopin_recorder, only : recorder_type, wants_type
   use lopin_atomic_file, only : write_atomically, read_text, remove_file, written_mark, is_foreign
   use lopin_text_buffer, only : text_buffer_type
   use lopin_recorder_table, only : is_due, has_variable, pair_name, file_word
   use lopin_vtu_writer, only : vtu_writer_type, vtu_cells_type
   use lopin_vtu_parts, only : surface_part_type, new_solid_cells, new_surface_part, write_solid, &
      & write_surface, write_tool
   implicit none
   private
   public :: vtu_recorder_type, new_vtu_recorder

   type, extends(recorder_type) :: vtu_recorder_type
      private
      character(len=:), allocatable :: folder, stem
      integer :: written = 0
      type(text_buffer_type) :: datasets
      type(vtu_writer_type) :: writer
      type(vtu_cells_type) :: solid
      type(surface_part_type), allocatable :: slave(:)
   contains
      procedure :: begin
      procedure :: increment
      procedure :: finish
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
      character(len=:), allocatable :: old
      integer :: i

      call new_solid_cells(self%solid, model)
      if (allocated(self%slave)) deallocate (self%slave)
      allocate (self%slave(size(model%pair)))
      do i = 1, size(model%pair)
         call new_surface_part(self%slave(i), model, model%pair(i)%slave)
      end do
      self%written = 0
      call self%datasets%clear()
      if (self%resumes) return
      call read_text(self%folder//'/'//self%stem//'.pvd', old)
      call write_pvd(self, error)
      if (allocated(error)) return
      call remove_listed(self%folder, self%stem, old)
   end subroutine begin

   subroutine increment(self, model, frame, error)
      class(vtu_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(frame_type), intent(in) :: frame
      type(error_type), allocatable, intent(out) :: error
      integer :: i, part

      if (.not. is_due(frequency_of(model, frame%step), frame)) return
      self%written = self%written + 1
      call write_solid(self%writer, model, self%solid, frame, shows(model, frame%step, 'U'), &
         & shows(model, frame%step, 'RF'))
      part = 0
      call write_part(self, 'solid', '', frame%total_time, part, error)
      if (allocated(error)) return
      do i = 1, size(model%pair)
         call write_surface(self%writer, model, self%slave(i), frame, frame%contact(i))
         call write_part(self, pair_name(model, i), 'contact_', frame%total_time, part, error)
         if (allocated(error)) return
      end do
      do i = 1, size(model%tool)
         call write_tool(self%writer, model, i, frame)
         call write_part(self, model%tool(i)%name, 'tool_', frame%total_time, part, error)
         if (allocated(error)) return
      end do
      call write_pvd(self, error)
   end subroutine increment

   subroutine keep(self, stream, error)
      class(vtu_recorder_type), intent(inout) :: self
      type(stream_type), intent(inout) :: stream
      type(error_type), allocatable, intent(out) :: error

      call stream%pass(self%written)
      call self%datasets%keep(stream)
      if (stream%reading .and. .not. stream%broken) call write_pvd(self, error)
   end subroutine keep

   subroutine finish(self, model, summary, failure, error)
      class(vtu_recorder_type), intent(inout) :: self
      type(model_type), intent(in) :: model
      type(summary_type), intent(in) :: summary
      type(error_type), allocatable, intent(in) :: failure
      type(error_type), allocatable, intent(out) :: error

      associate (unused => self, also => model, too => summary, and_this => failure, none => error)
      end associate
   end subroutine finish

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
   subroutine write_part(self, name, prefix, time, part, error)
      type(vtu_recorder_type), intent(inout) :: self
      character(len=*), intent(in) :: name      !! what the reader shows
      character(len=*), intent(in) :: prefix    !! '' (the solid), 'contact_', 'tool_'
      real(wp), intent(in) :: time
      integer, intent(inout) :: part
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: file
      character(len=12) :: number

      write (number, '(i0.4)') self%written
      file = self%stem//'_'
      if (len(prefix) > 0) file = file//prefix//file_word(name)//'_'
      file = file//trim(number)//'.vtu'
      if (is_foreign(self%folder//'/'//file)) then
         call raise(error, error_code%resource, 'E0603', "'"//self%folder//'/'//file// &
            & "' exists and was not written by Lopin", &
            & help='choose another folder with -o, or move the file away')
         return
      end if
      call self%writer%write(self%folder//'/'//file, error)
      if (allocated(error)) return
      call self%datasets%put_line('<DataSet timestep="'//to_text(time)//'" group="" part="' &
         & //to_text(part)//'" name="'//file_word(name)//'" file="'//file//'"/>')
      part = part + 1
   end subroutine write_part

   subroutine write_pvd(self, error)
      type(vtu_recorder_type), intent(in) :: self
      type(error_type), allocatable, intent(out) :: error
      character(len=*), parameter :: newline = achar(10)

      call write_atomically(self%folder//'/'//self%stem//'.pvd', '<?xml version="1.0"?>'//newline &
         & //written_mark//newline//'<VTKFile type="Collection" version="1.0" '// &
         & 'byte_order="LittleEndian">' &
         & //newline//'<Collection>'//newline//self%datasets%content()//'</Collection>'//newline &
         & //'</VTKFile>'//newline, error)
   end subroutine write_pvd

   !> Remove the `.vtu` that an older `.pvd` of ours lists, and nothing else.
   subroutine remove_listed(folder, stem, old)
      character(len=*), intent(in) :: folder, stem, old
      integer :: first, last, from

      if (index(old, written_mark) == 0) return
      from = 1
      do
         first = index(old(from:), 'file="')
         if (first == 0) exit
         first = from + first + 5
         last = first + index(old(first:), '"') - 2
         if (last < first) exit
         associate (name => old(first:last))
            if (index(name, '/') == 0 .and. index(name, stem//'_') == 1) then
               call remove_file(folder//'/'//name)
            end if
         end associate
         from = last + 1
      end do
   end subroutine remove_listed
end module lopin_recorder_vtu
