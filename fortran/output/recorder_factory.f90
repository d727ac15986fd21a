!> Which recorders a run needs: always the fields, the tables of increments and the summary;
!> `job.dat` and `job.frd` only if the deck asks for them. Files that Lopin did not write are never
!> touched.
!>
!> To add a recorder: a file `recorder_<name>.f90` that extends recorder_type, and its lines in
!> new_recorders.
module lopin_recorder_factory
   use lopin_error, only : error_type, error_code, raise
   use lopin_model, only : model_type, output_of
   use lopin_recorder, only : recorder_type, recorder_holder_type
   use lopin_atomic_file, only : make_folder, file_exists, read_text
   use lopin_safe_text, only : json_text
   use lopin_recorder_table, only : any_request
   use lopin_recorder_vtu, only : vtu_recorder_type, new_vtu_recorder
   use lopin_recorder_dat, only : dat_recorder_type, new_dat_recorder
   use lopin_recorder_frd, only : frd_recorder_type, new_frd_recorder
   use lopin_recorder_sta, only : sta_recorder_type, new_sta_recorder
   use lopin_recorder_history, only : history_recorder_type, new_history_recorder
   use lopin_recorder_json, only : json_recorder_type, new_json_recorder, json_schema, only_asked
   use lopin_recorder_memory, only : memory_recorder_type, new_memory_recorder
   implicit none
   private
   public :: new_recorders, append_memory

contains

   !> All recorders of files, the summary first: from then on `job.json` lists what is ours.
   subroutine new_recorders(list, model, folder, stem, error, deck_file)
      type(recorder_holder_type), allocatable, intent(out) :: list(:)
      type(model_type), intent(in) :: model
      character(len=*), intent(in) :: folder                    !! made if it is not there
      character(len=*), intent(in) :: stem                      !! job name, without path and suffix
      type(error_type), allocatable, intent(out) :: error
      character(len=*), intent(in), optional :: deck_file(:)    !! by file index of locations
      character(len=len(stem) + 12) :: file(7)
      character(len=:), allocatable :: base
      type(json_recorder_type), allocatable :: json
      type(vtu_recorder_type), allocatable :: vtu
      type(sta_recorder_type), allocatable :: sta
      type(history_recorder_type), allocatable :: history
      type(dat_recorder_type), allocatable :: dat
      type(frd_recorder_type), allocatable :: frd
      class(recorder_type), allocatable :: one
      logical :: tables, fields, stale(2)
      integer :: n

      tables = any_request(model, [output_of%node_print, output_of%element_print, &
         & output_of%contact_print])
      fields = any_request(model, [output_of%node_file, output_of%element_file, &
         & output_of%contact_file])
      file(:5) = [character(len=len(file)) :: stem//'.json', stem//'.pvd', stem//'.sta', &
         & stem//'.cvg', &
         & stem//'_history.csv']
      n = 5
      if (tables) call add_file('.dat')
      if (fields) call add_file('.frd')
      call make_folder(folder, error)
      if (allocated(error)) return
      call refuse_foreign(folder, stem, file(:n), stale, error)
      if (allocated(error)) return
      base = folder//'/'//stem
      allocate (list(0), json, vtu, sta, history, dat, frd)
      call new_json_recorder(json, base//'.json', file(:n), deck_file, stale)
      call move_alloc(json, one)
      call append(list, one)
      call new_vtu_recorder(vtu, folder, stem)
      call move_alloc(vtu, one)
      call append(list, one)
      call new_sta_recorder(sta, base//'.sta', base//'.cvg')
      call move_alloc(sta, one)
      call append(list, one)
      call new_history_recorder(history, base//'_history.csv')
      call move_alloc(history, one)
      call append(list, one)
      call new_dat_recorder(dat, base//'.dat')
      call move_alloc(dat, one)
      if (tables) call append(list, one)
      call new_frd_recorder(frd, base//'.frd')
      call move_alloc(frd, one)
      if (fields) call append(list, one)
   contains
      subroutine add_file(suffix)
         character(len=*), intent(in) :: suffix
         n = n + 1
         file(n) = stem//suffix
      end subroutine add_file
   end subroutine new_recorders

   !> Add a recorder that keeps everything in memory, as the last of the list.
   subroutine append_memory(list, deck_file)
      type(recorder_holder_type), allocatable, intent(inout) :: list(:)
      character(len=*), intent(in), optional :: deck_file(:)    !! by file index of locations
      type(memory_recorder_type), allocatable :: memory
      class(recorder_type), allocatable :: one

      allocate (memory)
      call new_memory_recorder(memory, deck_file)
      call move_alloc(memory, one)
      if (.not. allocated(list)) allocate (list(0))
      call append(list, one)
   end subroutine append_memory

   !> One more recorder at the end of the list. It is moved there: gfortran 12 copies texts of
   !> deferred length wrongly.
   subroutine append(list, recorder)
      type(recorder_holder_type), allocatable, intent(inout) :: list(:)
      class(recorder_type), allocatable, intent(inout) :: recorder
      type(recorder_holder_type), allocatable :: longer(:)
      integer :: i

      allocate (longer(size(list) + 1))
      do i = 1, size(list)
         call move_alloc(list(i)%recorder, longer(i)%recorder)
      end do
      call move_alloc(recorder, longer(size(longer))%recorder)
      call move_alloc(longer, list)
   end subroutine append

   !> A file that exists must be in the list of the `job.json` of an earlier run. What that run
   !> wrote and this one does not is told: it would look like results of this one.
   subroutine refuse_foreign(folder, stem, file, stale, error)
      character(len=*), intent(in) :: folder, stem, file(:)
      logical, intent(out) :: stale(:)         !! by suffix, `only_asked`
      type(error_type), allocatable, intent(out) :: error
      character(len=:), allocatable :: old
      logical :: ours
      integer :: i

      call read_text(folder//'/'//stem//'.json', old)
      ours = index(old, json_schema) > 0
      do i = 1, size(stale)
         stale(i) = ours .and. index(old, '"'//json_text(stem//only_asked(i))//'"') > 0 .and. &
            & .not. any(file == stem//only_asked(i))
      end do
      do i = 1, size(file)
         if (.not. file_exists(folder//'/'//trim(file(i)))) cycle
         if (ours .and. index(old, '"'//json_text(trim(file(i)))//'"') > 0) cycle
         call raise(error, error_code%resource, 'E0603', "'"//folder//'/'//trim(file(i))// &
            & "' exists and was not written by Lopin", &
            & note='a run replaces only the files that the job.json of an earlier run lists', &
            & help='choose another folder with -o, or move the file away')
         return
      end do
   end subroutine refuse_foreign
end module lopin_recorder_factory
